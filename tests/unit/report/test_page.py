from idealgas.report.page import description_html


def test_a_description_keeps_the_lines_of_its_tables():
    text = "Two\nlines.\n\n  time   event\n  1      v < 2\n\n  a command\n"
    shown = description_html(text).replace(' tabindex="0"', "")
    assert shown == "<p>Two lines.</p><pre>  time   event\n  1      v &lt; 2</pre><pre>  a command</pre>"
    assert description_html("") == ""


def test_commands_in_a_description_are_code():
    assert description_html("`a < b` and `c`.") == "<p><code>a &lt; b</code> and <code>c</code>.</p>"
