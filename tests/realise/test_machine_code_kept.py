"""Kept machine code: what runs is the source that was asked for, whatever a file holds."""

import pytest

from teleopdesign.realise import compiled

SOURCE = "from numba import njit\n\n\n@njit\ndef answer():\n    return {}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("TELEOPDESIGN_CACHE", str(tmp_path / "cache"))
    compiled.compiled_module.cache_clear()
    (tmp_path / "cache").mkdir(mode=0o700)
    yield compiled.cache_folder()
    compiled.compiled_module.cache_clear()


def files(folder):
    return sorted(p.name for p in folder.glob("teleopdesign_*.py"))


def test_each_source_has_a_file_of_its_content_and_no_other_has_it(folder):
    for number in (4, 5):
        assert compiled.compile_source(SOURCE.format(number), "answer").py_func() == number
    assert len(files(folder)) == 2
    held = {(folder / name).read_text() for name in files(folder)}
    assert held == {SOURCE.format(4), SOURCE.format(5)}
    assert [p.name for p in folder.iterdir() if p.name.startswith(".")] == []
    before = [(folder / name).stat().st_mtime_ns for name in files(folder)]
    compiled.compiled_module.cache_clear()
    assert compiled.compile_source(SOURCE.format(4), "answer").py_func() == 4
    assert before == [(folder / name).stat().st_mtime_ns for name in files(folder)]


def test_a_file_that_holds_something_else_is_neither_run_nor_left(folder):
    compiled.compile_source(SOURCE.format(4), "answer")
    (name,) = files(folder)
    (folder / name).write_text("raise SystemExit")
    compiled.compiled_module.cache_clear()
    assert compiled.compile_source(SOURCE.format(4), "answer").py_func() == 4
    assert (folder / name).read_text() == SOURCE.format(4)


def test_where_no_file_can_be_written_the_source_runs_all_the_same(folder, monkeypatch):
    monkeypatch.setattr(compiled, "cache_folder", lambda: folder / "gone")
    module = compiled.compiled_module(SOURCE.format(6), "answer")
    assert module["answer"].py_func() == 6 and module["__file__"].startswith("<")
    monkeypatch.setattr(compiled, "cache_folder", lambda: None)
    module = compiled.compiled_module(SOURCE.format(7), "answer")
    assert module["answer"].py_func() == 7 and module["__file__"].startswith("<")
    monkeypatch.setattr(compiled, "cache_folder", lambda: folder)
    module = compiled.compiled_module(SOURCE.format(8), "answer")
    assert module["__file__"] == str(folder / files(folder)[-1]) or len(files(folder)) == 1


def test_a_folder_that_others_write_to_or_that_is_a_link_is_not_used(tmp_path, monkeypatch):
    place = tmp_path / "cache"
    monkeypatch.setenv("TELEOPDESIGN_CACHE", str(place))
    kept = place / "machine_code"
    kept.mkdir(parents=True)
    kept.chmod(0o755)
    assert compiled.cache_folder() == kept and kept.stat().st_mode & 0o777 == 0o700
    for mode in (0o770, 0o707, 0o777):
        kept.chmod(mode)
        assert compiled.cache_folder() != kept
    kept.chmod(0o700)
    assert compiled.cache_folder() == kept
    kept.rename(place / "elsewhere")
    kept.symlink_to(place / "elsewhere")
    assert compiled.cache_folder() != kept


def test_code_counts_as_another_where_what_it_imports_has_changed(folder, monkeypatch):
    """The name of its file goes by the content of the modules of this package that it takes."""
    named = []

    def contents(paths):
        named.extend(paths)
        return str(len(named))

    monkeypatch.setattr(compiled, "hash_files", contents)
    source = "from teleopdesign.realise.lane_exp import exp\n" + SOURCE.format(1)
    for _ in range(2):
        compiled.compiled_module.cache_clear()
        compiled.compiled_module(source, "answer")
    assert len(files(folder)) == 2
    assert [p.name for p in named] == ["lane_exp.py"] * 2 and all(p.is_file() for p in named)
