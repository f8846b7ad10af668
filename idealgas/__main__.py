"""Run the command `idealgas` as `python -m idealgas`."""

from idealgas_cli.main import main

if __name__ == "__main__":
    main()
