"""The table of `tests/tools/mutants.py` follows the code."""

from tools.mutants import ROOT, TABLE, read_table


def test_every_change_applies_in_one_place_of_its_file():
    mutants = list(read_table(TABLE.read_text(encoding="utf-8")))
    assert len(mutants) > 400
    texts = {mutant.path: (ROOT / mutant.path).read_text(encoding="utf-8") for mutant in mutants}
    assert [mutant.old for mutant in mutants if texts[mutant.path].count(mutant.old) != 1] == []
    assert all(mutant.new != mutant.old for mutant in mutants)
    assert all((ROOT / test).exists() for mutant in mutants for test in mutant.tests)
