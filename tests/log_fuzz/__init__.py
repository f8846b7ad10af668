"""Logs that were made wrong on purpose or by chance, and every reading command on them in forked workers.

`sound` has the logs that all begin with, `editor` changes a log and makes its check sums right again, `values`,
`storage`, `structure` and `texts` are the changes, `crafted` draws them by a number, `damages` are accidents;
`commands` are taken from the program, `workers` run them within limits, `judge` says what may come out.
"""
