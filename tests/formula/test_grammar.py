"""What a formula may be made of; everything else is refused with its place, and nothing is evaluated."""

import pytest

from barrierbench_analysis.program.formula.grammar import MOST_CHARACTERS, FormulaError, read

LOG = "-(d - d_hat)^2*log(d/d_hat)"


@pytest.mark.parametrize("text", [LOG, " -( (d-d_hat)**2 )*ln(d / d_hat) ", "-(d - d_hat)^2 * log(d / d_hat)"])
def test_spellings_of_one_tree_are_one_formula(text):
    assert read(text).text == read(LOG).text


def test_another_tree_is_another_formula():
    assert read("-(d_hat - d)^2*log(d/d_hat)").text != read(LOG).text


def test_the_one_spelling_is_read_as_itself():
    for text in (LOG, "2/(3*d_hat)*(d_hat-d)^3", "d_hat^(3/2)*sqrt(d)", "(d_hat-d)^2*(d/d_hat)^-1", "d_hat^2*exp(-6*(d/d_hat))"):
        once = read(text).text
        assert read(once).text == once


@pytest.mark.parametrize("text, found", [
    ("__import__('os').system('true')", "the call"),
    ("d.real", '"d.real"'),
    ("eval(d)", "the call"),
    ("log(d/d_hat, 2)", "the call"),
    ("lambda: d", '"lambda: d"'),
    ("[d for d in d]", "[d for d in d]"),
    ("d_hat^2; import os", "breaks off at character 8"),
    ("import os", "breaks off"),
    ("$(touch x)", "breaks off at character 1"),
    ("`touch x`", "breaks off at character 1"),
    ("d if d else d_hat", "d if d else d_hat"),
    ("d*d and d", "and"),
    ("'a'", "'a'"),
    ("d_hat^2*1j", "1j at character 9"),
    ("d_hat^2*True", "True"),
    ("d*delta", 'the symbol "delta" at character 3'),
    ("d^d", "the exponent d at character 3"),
    ("d^9^9^9", "exponent"),
    ("d_hat^2*9^31^31", "the number 31^31"),
    ("d_hat^2*99^30", "the number 99^30"),
    ("d_hat^2*1e300", "the number 1e+300"),
    ("d_hat^2*0x10", "the number 0x10 at character 9"),
    ("d_hat^2*0b1", "the number 0b1 at character 9"),
    ("d_hat^2*1_000", "the number 1_000 at character 9"),
    ("d_hat^2 # a comment", "'#' at character 9"),
    ("# d_hat^2", "'#' at character 1"),
    ("d_hat^2*'#'", "'#' at character 10"),
    ("d_hat^2//2", '"d_hat ** 2 // 2"'),
    ("d_hat^2/(1 - 1)", "a division by 0 at character 10"),
    ("d*d\n", None),
    ("d*\td", "'\\t' at character 3"),
    ("d*d\u00b2", "at character 4"),
    ("", "0 characters"),
    ("d*" * MOST_CHARACTERS + "d", "801 characters"),
    ("(" * 190 + "d*d" + ")" * 190, None),
])
def test_nothing_but_the_whitelist(text, found):
    if found is None:
        text = text.strip()
        assert read(text).text == "d * d"
        return
    with pytest.raises(FormulaError) as error:
        read(text)
    assert found in error.value.found and error.value.allowed


@pytest.mark.parametrize("number", ["16", "16.", ".5", "0.5", "1e-3", "1E3", "1.5e+2"])
def test_numbers_are_decimal(number):
    assert read(f"d_hat^2*{number}").text == read(f"d_hat**2*{float(number)!r}" if float(number) != 16 or "." in number else "d_hat**2*16").text


def test_what_is_allowed_names_both_spellings_of_a_power():
    with pytest.raises(FormulaError) as error:
        read("d_hat^2*x")
    assert "^ (or **)" in error.value.allowed and "decimal numbers" in error.value.allowed


@pytest.mark.parametrize("text, found", [
    ("d_hat - d", "the unit m"),
    ("(d_hat - d)^3", "the unit m^3"),
    ("log(d/d_hat)", "the unit 1"),
    ("d^(3/2)", "the unit m^(3/2)"),
    ("(d_hat - d)^2 + d", "the sum of m^2 and m at character 1"),
    ("d_hat^2*(1 - d)", "the sum of 1 and m at character 10"),
    ("d_hat^2*log(d)", "log of m at character 9"),
    ("d_hat^2*exp(d*d_hat)", "exp of m^2 at character 9"),
])
def test_the_unit_is_square_metres(text, found):
    with pytest.raises(FormulaError) as error:
        read(text)
    assert found in error.value.found
