"""Every mistake in experiment.toml is one line: where, what was found, what was expected."""

import pytest
from measurement.rod_example import assert_says, error_of

from teleopdesign.measurement import load_experiment

TIME = 'time = { column = "t", unit = "s" }'
POSITION = 'position = { column = "x", unit = "mm", resolution = 5e-3 }'
FORCE = 'actuator_force = { column = "u", unit = "N" }'
INERTIA = 'inertia = { value = 0.15, unit = "kg", fixed = false }'
LEVEL = "coulomb = { level = { value = 0.50"
RATE = 'sample_rate = { value = 100, unit = "Hz" }'
MODEL = "[model.device]"
FIT = 'file = "fit.csv"'
BANDWIDTH = "bandwidth = { value = 20"

# what the user wrote instead -> what the message must say
IN_THE_TOML = {
    "syntax": ("[channels]", "[channels", "not valid TOML: .*line 10"),
    "key given twice": (FORCE, FORCE + "\n" + FORCE, "not valid TOML: .*line 13"),
    "unknown table": ("[comparison]", "[comparsion]", 'unknown key "comparsion".*"comparison"'),
    "unknown key of a body": ("axis =", "axes =", 'model.device: unknown key "axes".*"axis"'),
    "unknown key of a channel": ("noise =", "nois =", 'interaction_force: unknown key "nois"'),
    "unknown key of a value": ("fixed =", "fix =", 'inertia: unknown key "fix".*"fixed"'),
    "quantity of a body not there": ("position =", '"slave.position" =', 'no "?quantity "slave'),
    "unknown axis": ('"prismatic"', '"prismatc"', 'axis: found "prismatc".*mean "prismatic"'),
    "no axis": ('axis = "prismatic"\n', "", 'model.device: no key "axis"'),
    "unknown body": ("model.device]", "model.devise]", 'unknown key "devise".*"device"'),
    "only a master": ("model.device]", "model.master]", "expected .*device"),
    "text for a number": ("value = 0.15", 'value = "0.15"', 'value: found "0.15", expected a num'),
    "table for a number": (LEVEL, "coulomb = { level = { value = {}", "found a table"),
    "nan": ("value = 0.15", "value = nan", "inertia.value: found nan, expected a finite number"),
    "number of 400 digits": ("value = 0.15", "value = 1" + "0" * 400, "expected a finite number"),
    "negative inertia": ("value = 0.15", "value = -0.15", "found -0.15, expected .* above 0"),
    "resolution of zero": ("resolution = 5e-3", "resolution = 0", "expected .* above 0"),
    "text for a table": ("viscous = {}", 'viscous = "yes"', 'viscous: found "yes", expected a tab'),
    "empty column": ('column = "t"', 'column = ""', 'time.column: found "", expected a text'),
    "no unit": (FORCE, 'actuator_force = { column = "u" }', 'actuator_force: no key "unit"'),
    "no column": (FORCE, 'actuator_force = { unit = "N" }', 'actuator_force: no key "column"'),
    "unit of something else": (
        'column = "x", unit = "mm"',
        'column = "x", unit = "N"',
        'channels.position.unit: found "N", expected a length such as "m" or "mm"$',
    ),
    "unit of the other axis": ('"prismatic"', '"revolute"', 'found "kg", expected a moment of in'),
    "unknown unit": ('unit = "mm"', 'unit = "mmm"', 'found "mmm".*; did you mean "mm"?'),
    "no position": (POSITION, "", 'channels: no "position", found time, actuator_force'),
    "no command": (FORCE, "", 'channels: no "actuator_force", found time, position'),
    "no time": (TIME, "", 'channels: no "time", expected .*sample_rate'),
    "time and rate": (TIME, TIME + "\n" + RATE, "sample_rate: found beside channels.time"),
    "negative rate": (TIME, RATE.replace("100", "-100"), "found -100, expected .* above 0"),
    "rate in seconds": (TIME, RATE.replace("Hz", "s"), 'found "s", expected a frequency'),
    "column used twice": ('column = "u"', 'column = "x"', 'found column "x", which'),
    "channel given twice": (POSITION, POSITION + '\n"device.' + POSITION.replace(" =", '" =', 1),
                            "device.position.* is given twice"),
    "no fit record": ('use = "fit"', 'use = "check"', 'none with use = "fit"'),
    "no record": ("[[records]]\n" + FIT + '\nuse = "fit"\n', "", "found 1 records, none with"),
    "records as a table": ("[comparison]", "[records]\n[comparison]", "not valid TOML"),
    "unknown use": ('use = "fit"', 'use = "fti"', r'records\[1\].use: found "fti".*mean "fit"?'),
    "unknown zero": ('"own"', '"mine"', 'position_zero: found "mine", expected common, own'),
    "no file": ('file = "check.csv"', 'file = "chek.csv"', 'no file "chek.csv".*mean "check.csv"?'),
    "file listed twice": ('file = "check.csv"', FIT, '"fit.csv" is listed twice'),
    "file outside": (FIT, 'file = "../fit.csv"', "expected a file inside rod/"),
    "a folder as file": (FIT, 'file = "."', 'no file "."'),
    "null character in a file": (FIT, 'file = "a\\u0000b"', "cannot be read"),
    "name of 5000 characters": (FIT, f'file = "{"a" * 5000}"', r"cannot be read|no file"),
    "kind of file": (FIT, 'file = "experiment.toml"', 'kind ".toml", expected .csv'),
    "no such column": ('column = "x"', 'column = "x_pos"', 'channels.position: no column'),
    "bandwidth above the samples'": (BANDWIDTH, "bandwidth = { value = 60", "less than 50 Hz"),
    "bandwidth in seconds": ('unit = "Hz"', 'unit = "ms"', "bandwidth.unit: .*a frequency such as"),
    "line break in a key": ("viscous = {}", '"a\\nb" = 3', r"effects.a\\nb: found a whole number"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", IN_THE_TOML)
def test_a_mistake_in_the_toml_is_named(rod, edit, mistake):
    old, new, expected = IN_THE_TOML[mistake]
    edit(rod / "experiment.toml", old, new)
    message = error_of(rod)
    assert message.startswith("rod/")
    assert_says(message, expected)


def test_no_such_column_lists_the_columns_of_the_file_and_the_nearest(rod, edit):
    edit(rod / "fit.csv", "t,u,x,f_h", "t,u,x_pos,f_h")
    edit(rod / "experiment.toml", 'column = "x"', 'column = "pos"')
    assert error_of(rod) == (
        'rod/fit.csv: channels.position: no column "pos", found t, u, x_pos, f_h; '
        'did you mean "x_pos"?'
    )


def test_a_segment_that_is_no_whole_number_is_named(rod, edit):
    edit(
        rod / "experiment.toml",
        'column = "f_h", unit = "N", noise = 0.01',
        'column = "h", unit = "N"',
    )
    edit(rod / "experiment.toml", "[comparison]", 'segment = { column = "f_h" }\n[comparison]')
    for name in ("fit.csv", "check.csv"):
        lines = (rod / name).read_text().splitlines()
        (rod / name).write_text("\n".join([lines[0] + ",h", *(line + ",1" for line in lines[1:])]))
    assert_says(error_of(rod), "channels.segment: row 2: found 0.001, expected a whole number")


def test_a_folder_that_does_not_exist_is_named(rod):
    assert error_of(rod.parent / "rodd") == 'rodd: no such folder; did you mean "rod"?'


def test_a_folder_without_experiment_lists_what_it_holds(rod):
    (rod / "experiment.toml").rename(rod / "experimnt.toml")
    assert error_of(rod) == (
        "rod: no experiment.toml, found check.csv, experimnt.toml, fit.csv; "
        'did you mean "experimnt.toml"?'
    )


def test_a_record_file_stands_for_its_folder(rod):
    assert load_experiment(rod / "fit.csv") == load_experiment(rod)
    assert_says(error_of(rod / "fat.csv"), 'fat.csv: no such folder; did you mean "fit.csv"')
