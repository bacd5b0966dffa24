"""The one moment that holds what is left: where, how long, and what is left without it."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose.stand_ins import Leaves

from teleopdesign.diagnose.adequacy import moment_above_noise
from teleopdesign.diagnose.noise_floor import NoiseFloor
from teleopdesign.diagnose.one_moment import MOMENTS, worst_moment
from teleopdesign.diagnose.solve import BLOCK

RATE = 100.0
PER_BLOCK = round(BLOCK * RATE)


def stretch(file, blocks):
    n = blocks * PER_BLOCK
    # the record goes on beyond the rows that count
    motion = SimpleNamespace(time=50.0 + np.arange(n + 20) / RATE, file=file, body="device")
    return SimpleNamespace(motion=motion, keep=np.arange(10, n + 10))


def left(blocks, loud, *, size=10.0, floor=0.5, at_command=1.0):
    """Of stretches with so many blocks: a residual of one, and `size` in the blocks `loud`."""
    stretches = [stretch(f"check_{i}.csv", b) for i, b in enumerate(blocks)]
    residual = np.ones(sum(blocks) * PER_BLOCK)
    for k in loud:
        residual[k * PER_BLOCK : (k + 1) * PER_BLOCK] = size
    error = float(np.sqrt(np.mean(residual**2)))
    command = SimpleNamespace(residual=residual, error=error, blind=0.0)
    fit = Leaves(at_command=command, check_error=error)
    prepared = SimpleNamespace(of=lambda use: stretches if use == "check" else [])
    return fit, prepared, NoiseFloor(floor, "made", floor, at_command=at_command)


@pytest.mark.parametrize(("at", "file", "begin"), [(5, 0, 5), (12, 0, 12), (17, 1, 3)])
def test_two_neighbouring_blocks_with_most_of_it_are_detected_with_what_is_left_without(
    at, file, begin
):
    fit, prepared, floor = left((14, 16), (at, at + 1), at_command=0.8)
    moment = worst_moment(fit, prepared, floor)
    assert (moment.file, moment.body) == (f"check_{file}.csv", "device")
    first = 50.0 + (10 + begin * PER_BLOCK) / RATE
    assert moment.begin == pytest.approx(first)
    assert moment.end == pytest.approx(first + (2 * PER_BLOCK - 1) / RATE)
    # all other rows leave one: over the floor at the command
    assert moment.without == pytest.approx(1.0 / (0.5 * 0.8))
    assert str(moment) == f"device in {moment.file}, {moment.begin:.2f} to {moment.end:.2f} s"


def test_blocks_of_two_stretches_are_no_moment():
    """The last of one record and the first of the next are far apart, however loud both are."""
    fit, prepared, floor = left((14, 16), (13, 14))
    moment = worst_moment(fit, prepared, floor)
    assert moment.end - moment.begin < 2.0 * BLOCK
    assert moment.without > 1.0 / 0.5


def test_of_fewer_than_ten_moments_none_is_left_out():
    assert worst_moment(*left((2 * MOMENTS,), (4, 5))) is not None
    assert worst_moment(*left((2 * MOMENTS - 1,), (4, 5))) is None
    fit, prepared, floor = left((2 * MOMENTS,), (4, 5), floor=0.0)
    assert worst_moment(fit, prepared, floor) is None, "no noise to hold it against"
    nothing = left((2 * MOMENTS,), (), size=1.0)
    nothing[0].at_command.residual[:] = 0.0
    assert worst_moment(*nothing) is None


@pytest.mark.parametrize(("floor", "loud", "is_one"), [(0.6, (4, 5), True), (0.5, (4, 5), False),
                                                       (0.6, (4, 9), False)])  # fmt: skip
def test_a_moment_counts_where_only_noise_is_left_without_it(floor, loud, is_one):
    """Noise is what is below 1.8 floors: of 0.6, one is; of 0.5, it is not; nor at two moments."""
    fit, prepared, known = left((24,), loud, floor=floor)
    assert (moment_above_noise(fit, prepared, known) is not None) == is_one
    quiet, prepared, known = left((24,), (), floor=0.6)
    assert moment_above_noise(quiet, prepared, known) is None, "all of it is noise"


@pytest.mark.parametrize("seed", range(12))
def test_the_worst_pair_of_blocks_by_brute_force_where_rows_are_missing(seed):
    """Blocks of a quarter of a second with many rows, few, or none."""
    rng = np.random.default_rng(seed)
    stretches, blocks = [], []
    for k, length in enumerate(rng.integers(500, 900, 2)):
        motion = SimpleNamespace(
            time=7.0 * k + np.arange(length) / RATE, file=f"{k}", body="device"
        )
        here = rng.random(length) < 0.5
        for _ in range(2):
            gap = int(rng.integers(50, length - 100))
            here[gap : gap + 60] = False
        keep = np.flatnonzero(here)
        stretches.append(SimpleNamespace(motion=motion, keep=keep))
        time = motion.time[keep]
        blocks += [(k, int(b)) for b in (time - time[0]) / BLOCK]
    residual = rng.standard_normal(len(blocks)) * (1.0 + 5.0 * (rng.random(len(blocks)) < 0.02))
    error = 0.7
    command = SimpleNamespace(residual=residual, error=error)
    prepared = SimpleNamespace(of=lambda use: stretches)
    moment = worst_moment(
        SimpleNamespace(at_command=command), prepared, NoiseFloor(0.2, "made", 0.2)
    )
    pairs = {}
    for k, b in set(blocks):
        inside = np.array([one in ((k, b), (k, b + 1)) for one in blocks])
        if (k, b + 1) in blocks:
            pairs[k, b] = inside
    worst = max(pairs, key=lambda pair: np.sum(residual[pairs[pair]] ** 2))
    inside = pairs[worst]
    assert moment.file == str(worst[0])
    times = np.concatenate([s.motion.time[s.keep] for s in stretches])[inside]
    assert (moment.begin, moment.end) == (times[0], times[-1])
    rms = [np.sqrt(np.mean(r**2)) for r in (residual[~inside], residual)]
    assert moment.without == pytest.approx(error / 0.2 * rms[0] / rms[1])
