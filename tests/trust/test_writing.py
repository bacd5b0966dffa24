"""Every file of the package is written beside its target and takes its name when it is whole."""

import ast
from pathlib import Path

import teleopdesign

PACKAGE = Path(teleopdesign.__file__).parent

#: what writes a file at once -> where its path stands: before the dot, or the last argument
AT_ONCE = {"write_text": "object", "write_bytes": "object"} | dict.fromkeys(
    ("to_netcdf", "savefig", "copyfile"), "argument"
)

#: a study writes itself so; a recording's folder is written under another name
ELSEWHERE = {
    "studies/run.py: result.to_netcdf",
    "measurement/recordings/__init__.py: (unfinished / 'experiment.toml').write_text",
}


def test_every_file_is_written_beside_its_target():
    """In the package, files are written to the path that `write_beside` gives, named `part`."""
    wrong = []
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    for path, text in texts.items():
        if not any(f".{name}(" in text for name in AT_ONCE):
            continue
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
                continue
            if (where := AT_ONCE.get(node.func.attr)) is None:
                continue
            target = node.func.value if where == "object" else node.args[-1]
            if not (isinstance(target, ast.Name) and target.id in ("part", "out")):
                wrong.append(f"{path.relative_to(PACKAGE)}: {ast.unparse(node.func)}")
    assert [w for w in wrong if w not in ELSEWHERE] == []
