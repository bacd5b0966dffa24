"""Names and sizes that few pages have."""

from base64 import b64decode

from teleopdesign.show.report.figures import picture


def test_a_name_with_two_dollar_signs_stays_as_it_is_written():
    made = picture(
        lambda f: f.add_subplot().set_title("joint $a_1$"), size=(2.0, 1.0), alt="a joint"
    )
    svg = b64decode(str(made).partition("base64,")[2].partition('"')[0]).decode()
    assert ">joint $a_1$</text>" in svg
