"""`python -m idealgas` is the command `idealgas`."""

from idealgas_cli.main import main

if __name__ == "__main__":
    main()
