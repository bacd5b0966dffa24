"""Files of MATLAB written element by element: what the format allows passes, and nothing else."""

import struct
import zlib

import pytest

from teleopdesign.measurement.doors.matlab import check_elements

#: types of the format, by its manual: integers of 8, 16, 32 bits, floats, 64 bits, characters
NUMBERS = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 16: 1, 17: 2, 18: 4}
INT8, INT32, UINT32, DOUBLE, MATRIX, COMPRESSED = 1, 5, 6, 9, 14, 15
CELL, STRUCT, OBJECT, CHAR, SPARSE, DOUBLES, FUNCTION, OPAQUE = 1, 2, 3, 4, 5, 6, 16, 17


def element(kind, content, order="<", *, small=None, size=None):
    """One element with its tag, padded to eight bytes; small: in the short form."""
    small = len(content) <= 4 and kind != MATRIX if small is None else small
    size = len(content) if size is None else size
    if small:
        return struct.pack(f"{order}I", size << 16 | kind) + content.ljust(4, b"\0")
    pad = b"" if kind == COMPRESSED else b"\0" * (-len(content) % 8)
    return struct.pack(f"{order}II", kind, size) + content + pad


def matrix(held, sizes=(1, 1), rest=(), order="<", *, flags=0):
    head = element(UINT32, struct.pack(f"{order}II", flags << 8 | held, 0), order)
    shape = element(INT32, struct.pack(f"{order}{len(sizes)}i", *sizes), order)
    name = element(INT8, b"x", order)
    return element(MATRIX, head + shape + name + b"".join(rest), order)


def structure(count, names=("a", "b"), longest=8, held=STRUCT, order="<", inner=None):
    fields = b"".join(n.encode().ljust(longest, b"\0") for n in names)
    rest = [element(INT8, b"cls", order)] if held == OBJECT else []
    rest += [element(INT32, struct.pack(f"{order}i", longest), order), element(INT8, fields, order)]
    inner = matrix(DOUBLES, (1, 1), [number(order)], order) if inner is None else inner
    return matrix(held, (1, 1), [*rest, *[inner] * count], order)


def number(order="<"):
    return element(DOUBLE, struct.pack(f"{order}d", 1.5), order)


def check(tmp_path, *elements, order="<", mark=None):
    path = tmp_path / "a.mat"
    mark = {"<": b"\0\1IM", ">": b"\1\0MI"}[order] if mark is None else mark
    path.write_bytes(b"MATLAB".ljust(124) + mark + b"".join(elements))
    check_elements(path)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("held", range(4, 16))
def test_numbers_of_every_type_and_class_pass_in_both_orders_of_bytes(tmp_path, held, order):
    for kind, size in NUMBERS.items():
        content = [element(kind, b"\1" * size, order), element(kind, b"\1" * (3 * size), order)]
        check(tmp_path, matrix(held, (1, 3), content, order, flags=2), order=order)


@pytest.mark.parametrize("kind", [0, 8, 10, 11, 14, 15, 19, 99])
def test_numbers_of_a_type_that_the_format_does_not_have_are_refused(tmp_path, kind):
    broken = matrix(DOUBLES, (1, 1), [element(kind, b"\0" * 8, small=False)])
    for content in (broken, element(COMPRESSED, zlib.compress(broken))):
        with pytest.raises(ValueError, match="numbers of no known type"):
            check(tmp_path, matrix(DOUBLES, (1, 1), [number()]), content)
    # another version is for other code, and so is what is no matrix
    check(tmp_path, broken, mark=b"\0\2IM")
    check(tmp_path, element(DOUBLE, b"\0" * 8))


@pytest.mark.parametrize("held", [0, 18, 255])
def test_a_class_that_the_format_does_not_have_is_refused(tmp_path, held):
    with pytest.raises(ValueError, match=f"a matrix of class {held}"):
        check(tmp_path, matrix(held))


def test_structs_cells_objects_and_functions_are_looked_into(tmp_path):
    one = matrix(DOUBLES, (1, 1), [number()])
    for held in (STRUCT, OBJECT):
        check(tmp_path, structure(2, held=held), one)
        for count in (1, 3):
            with pytest.raises(ValueError, match=f"found {count} parts .* expected 2"):
                check(tmp_path, structure(count, held=held))
        with pytest.raises(ValueError, match="without names"):
            check(tmp_path, structure(2, longest=0, held=held))
    check(tmp_path, matrix(CELL, (2, 3), [one] * 6), matrix(CELL, (0, 0)))
    with pytest.raises(ValueError, match="found 5 parts of a struct or cell, expected 6"):
        check(tmp_path, matrix(CELL, (2, 3), [one] * 5))
    with pytest.raises(ValueError, match="found 1 parts"):
        check(tmp_path, matrix(CELL, (1, 1), [number()]))
    # a function holds any number of matrices, and nothing else; what is opaque holds anything
    check(tmp_path, matrix(FUNCTION, (1, 1), [one] * 3), matrix(OPAQUE, (1, 1), [element(99, b"")]))
    with pytest.raises(ValueError, match="parts of a struct or cell"):
        check(tmp_path, matrix(FUNCTION, (1, 1), [number()]))
    bad = matrix(99)
    for outer in (
        matrix(CELL, (1, 1), [bad]),
        structure(2, inner=bad),
        matrix(FUNCTION, rest=[bad]),
    ):
        with pytest.raises(ValueError, match="class 99"):
            check(tmp_path, one, outer)


@pytest.mark.parametrize(("depth", "passes"), [(50, True), (51, False)])
def test_cells_are_nested_at_most_fifty_deep(tmp_path, depth, passes):
    inner = matrix(DOUBLES, (1, 1), [number()])
    for _ in range(depth):
        inner = matrix(CELL, (1, 1), [inner])
    if passes:
        check(tmp_path, inner)
        return
    with pytest.raises(ValueError, match="nested too deeply"):
        check(tmp_path, inner)


def test_a_matrix_without_class_or_size_is_refused(tmp_path):
    flags = element(UINT32, struct.pack("<II", DOUBLES, 0))
    name, size = element(INT8, b"x"), element(INT32, struct.pack("<2i", 1, 1))
    check(tmp_path, element(MATRIX, b""), element(MATRIX, flags + size + name + number()))
    check(tmp_path, element(MATRIX, flags + element(UINT32, struct.pack("<2i", 1, 1)) + name))
    for content, message in [
        (element(UINT32, b"\6\0\0\0"), "without its class"),
        (flags, "without its size"),
        (flags + size, "without its size"),
        (flags + element(DOUBLE, b"\1" * 8) + name, "without its size"),
        (flags + element(INT32, b"\1" * 7) + name, "without its size"),
        (flags + element(INT32, struct.pack("<2i", 1, -1)) + name, "of size"),
    ]:
        with pytest.raises(ValueError, match=message):
            check(tmp_path, element(MATRIX, content))


def test_an_element_that_ends_behind_the_file_or_its_word_is_refused(tmp_path):
    whole = element(DOUBLE, b"\0" * 24)
    check(tmp_path, whole, b"\0" * 7)
    for cut in (whole[:-1], element(DOUBLE, b"\0" * 8, size=9)):
        with pytest.raises(ValueError, match="ends behind what holds it"):
            check(tmp_path, cut)
    check(tmp_path, element(INT8, b"abcd", small=True), whole)
    with pytest.raises(ValueError, match="an element of 5 bytes"):
        check(tmp_path, element(INT8, b"abcd", small=True, size=5), whole)
    # elements begin at each eighth byte, and a compressed one ends where it ends
    bad = matrix(99)
    for before in (
        element(INT8, b"abcde", small=False),
        element(COMPRESSED, zlib.compress(b"abc")),
    ):
        with pytest.raises(ValueError, match="class 99"):
            check(tmp_path, before, bad)
