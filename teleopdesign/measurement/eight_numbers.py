"""Eight numbers side by side as one value of compiled code: they stay in registers.

A compiler makes vector instructions of a loop over an array's columns, but keeps what such a loop
remembers from row to row in memory, and asks at each row whether two arrays overlap. A recursive
filter then waits for its own memory.

    x = take(numbers, at)           numbers[at : at + 8] of a flat array without gaps
    put(x, numbers, at)             the same, written
    add(x, y), subtract(x, y), scale(a, x)
    scale_and_add(a, x, y)          a x + y, rounded once where the processor has an instruction
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, models, register_model

#: numbers of one value
EIGHT = 8
_VECTOR = ir.VectorType(ir.DoubleType(), EIGHT)


class _Eight(types.Type):  # type: ignore[misc,unused-ignore]
    """The type of the value in compiled code."""

    def __init__(self) -> None:
        super().__init__(name="EightNumbers")


_EIGHT = _Eight()


@register_model(_Eight)
class _EightModel(models.PrimitiveModel):  # type: ignore[misc,unused-ignore]
    def __init__(self, manager: Any, of_type: Any) -> None:
        super().__init__(manager, of_type, _VECTOR)  # type: ignore[no-untyped-call,unused-ignore]


def _place(context: Any, builder: Any, array_type: Any, array: Any, at: Any) -> Any:
    """Address of eight numbers of an array."""
    data = context.make_array(array_type)(context, builder, value=array).data
    return builder.bitcast(builder.gep(data, [at]), _VECTOR.as_pointer())


def _spread(builder: Any, number: Any) -> Any:
    """Eight times the same number."""
    one = builder.insert_element(
        ir.Constant(_VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0)
    )
    first = ir.Constant(ir.VectorType(ir.IntType(32), EIGHT), [0] * EIGHT)
    return builder.shuffle_vector(one, ir.Constant(_VECTOR, ir.Undefined), first)


def _take(context: Any, numbers: Any, at: Any) -> Any:
    """Eight numbers of a flat array, from a place on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = _place(context, builder, signature.args[0], *arguments)
        return builder.load(place, align=8)

    return _EIGHT(numbers, types.intp), generate


def _put(context: Any, eight: Any, numbers: Any, at: Any) -> Any:
    """Write eight numbers into a flat array, from a place on."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = _place(context, builder, signature.args[1], *arguments[1:])
        builder.store(arguments[0], place, align=8)
        return context.get_dummy_value()

    return types.none(_EIGHT, numbers, types.intp), generate


def _of_two(operation: str) -> Callable[..., Any]:
    def typed(context: Any, x: Any, y: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return getattr(builder, operation)(*arguments)

        return _EIGHT(_EIGHT, _EIGHT), generate

    return typed


def _scale(context: Any, factor: Any, x: Any) -> Any:
    """A number times eight."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fmul(_spread(builder, arguments[0]), arguments[1])

    return _EIGHT(types.float64, _EIGHT), generate


def _scale_and_add(context: Any, factor: Any, x: Any, y: Any) -> Any:
    """A number times eight, and eight more."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        flags = ("contract",)
        scaled = builder.fmul(_spread(builder, arguments[0]), arguments[1], flags=flags)
        return builder.fadd(scaled, arguments[2], flags=flags)

    return _EIGHT(types.float64, _EIGHT, _EIGHT), generate


#: what compiled code calls
Operation = Callable[..., Any]
take: Operation = intrinsic(_take)
put: Operation = intrinsic(_put)
add: Operation = intrinsic(_of_two("fadd"))
subtract: Operation = intrinsic(_of_two("fsub"))
scale: Operation = intrinsic(_scale)
scale_and_add: Operation = intrinsic(_scale_and_add)
