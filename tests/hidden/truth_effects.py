"""The effects a case may hide: strength, shape, public parameter names and units.

A strength of 1 is about the largest that one would meet; `draw` turns it into parameters of the
simulator.  `Scale` holds what is typical of the machine: force, speed, size of motion, duration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

Values = dict[str, float]
LINEAR = {
    "force": "N", "stiffness": "N/m", "damping": "N*s/m", "inertia": "kg", "velocity": "m/s",
    "time": "s", "length": "m", "drag": "N*s^2/m^2", "hardening": "N/m^3", "ratio": "1",
    "angle": "rad", "frequency": "Hz", "place_damping": "N*s/m^3", "power_stiffness": "N/m^n",
    "thinning": "N",
}  # fmt: skip
ANGULAR = {
    "force": "N*m", "stiffness": "N*m/rad", "damping": "N*m*s/rad", "inertia": "kg*m^2",
    "velocity": "rad/s", "time": "s", "length": "rad", "drag": "N*m*s^2/rad^2",
    "hardening": "N*m/rad^3", "ratio": "1", "angle": "rad", "frequency": "Hz",
    "place_damping": "N*m*s/rad^3", "power_stiffness": "N*m/rad^n", "thinning": "N*m",
}  # fmt: skip
UNITS = {"prismatic": LINEAR, "revolute": ANGULAR}

TEN = (
    "viscous", "coulomb", "coulomb_asymmetry", "stribeck", "presliding", "bias", "spring",
    "added_inertia", "actuation_delay", "actuator_lag",
)  # fmt: skip
OTHERS = (
    "quadratic_drag", "viscous_asymmetry", "position_dependent_friction", "load_dependent_friction",
    "friction_drift", "friction_memory", "hardening_spring", "cogging", "transmission_compliance",
    "backlash", "actuator_saturation", "actuator_gain", "torque_ripple",
    "gravity", "shear_thinning", "maxwell_slip",
)  # fmt: skip
CONTACT = ("contact_damping", "contact_hardening")
OUTSIDE = ("outside_hum", "outside_position_dependent_damping", "outside_slow_force")

# public name of a parameter -> (name in the simulator, kind of unit)
PUBLIC: dict[str, dict[str, tuple[str, str]]] = {
    "viscous": {"damping": ("damping", "damping")},
    "coulomb": {"level": ("level", "force")},
    "coulomb_asymmetry": {"half_difference": ("half_difference", "force")},
    "stribeck": {
        "extra_static_level": ("extra_static_level", "force"),
        "stribeck_velocity": ("stribeck_velocity", "velocity"),
    },
    "presliding": {
        "stiffness": ("presliding", "stiffness"),
        "bristle_damping": ("bristle_damping", "damping"),
    },
    "bias": {"force": ("bias", "force")},
    "spring": {"stiffness": ("spring", "stiffness")},
    "added_inertia": {"inertia": ("added_inertia", "inertia")},
    "actuation_delay": {"delay": ("delay", "time")},
    "actuator_lag": {"time_constant": ("lag", "time")},
    "quadratic_drag": {"drag": ("drag", "drag")},
    "viscous_asymmetry": {"half_difference": ("damping_difference", "damping")},
    "position_dependent_friction": {
        "amplitude": ("level_wave", "ratio"),
        "period": ("level_wave_period", "length"),
        "phase": ("level_wave_phase", "angle"),
    },
    "load_dependent_friction": {"coefficient": ("load_coefficient", "ratio")},
    "friction_drift": {
        "fraction": ("drift_fraction", "ratio"),
        "time_constant": ("drift_time", "time"),
    },
    "friction_memory": {"time_constant": ("memory_time", "time")},
    "hardening_spring": {"stiffness": ("hardening", "hardening")},
    "cogging": {
        "amplitude": ("cogging", "force"),
        "period": ("cogging_period", "length"),
        "phase": ("cogging_phase", "angle"),
    },
    "transmission_compliance": {
        "tip_inertia": ("tip_inertia", "inertia"),
        "stiffness": ("tip_stiffness", "stiffness"),
        "damping": ("tip_damping", "damping"),
    },
    "backlash": {
        "tip_inertia": ("tip_inertia", "inertia"),
        "stiffness": ("tip_stiffness", "stiffness"),
        "damping": ("tip_damping", "damping"),
        "gap": ("gap", "length"),
    },
    "actuator_saturation": {"limit": ("limit", "force")},
    "actuator_gain": {"gain": ("gain", "ratio")},
    "torque_ripple": {
        "amplitude": ("ripple", "ratio"),
        "period": ("ripple_period", "length"),
        "phase": ("ripple_phase", "angle"),
    },
    "gravity": {"amplitude": ("gravity", "force"), "phase": ("gravity_phase", "angle")},
    "shear_thinning": {
        "drag": ("thinning", "thinning"),
        "exponent": ("thinning_power", "ratio"),
    },
    "maxwell_slip": {
        "stiffness_1": ("slip_k1", "stiffness"),
        "stiffness_2": ("slip_k2", "stiffness"),
        "level_2": ("slip_w2", "force"),
        "stiffness_3": ("slip_k3", "stiffness"),
        "level_3": ("slip_w3", "force"),
        "stiffness_4": ("slip_k4", "stiffness"),
        "level_4": ("slip_w4", "force"),
    },
    # beside `transmission_compliance` or `backlash`, which the reference does not re-estimate
    "tip_friction": {"level": ("tip_level", "force")},
    "contact_damping": {"damping": ("contact_damping", "damping")},
    "contact_hardening": {"power": ("contact_power", "ratio")},
    "outside_hum": {"amplitude": ("hum", "force"), "frequency": ("hum_frequency", "frequency")},
    "outside_position_dependent_damping": {"coefficient": ("place_damping", "place_damping")},
    "outside_slow_force": {
        "amplitude": ("slow_force", "force"),
        "frequency": ("slow_frequency", "frequency"),
    },
}
NO_INVERSE = {
    "transmission_compliance", "backlash", "friction_memory", "maxwell_slip", *OUTSIDE,
}  # fmt: skip
#: effects of a revolute axis alone
REVOLUTE = {"gravity"}
NEEDS_LEVEL = {
    "coulomb_asymmetry", "stribeck", "presliding", "position_dependent_friction",
    "load_dependent_friction", "friction_drift", "friction_memory", "maxwell_slip",
}  # fmt: skip


@dataclass
class Scale:
    force: float
    speed: float
    size: float
    duration: float
    resolution: float


def shape(rng: np.random.Generator) -> Values:
    """Numbers that set the form of an effect, drawn once so that its strength can be scaled."""
    return {name: float(rng.uniform()) for name in "abcd"} | {
        "sign": float(rng.choice([-1.0, 1.0]))
    }


def draw(effect: str, base: Values, scale: Scale, strength: float, q: Values) -> Values:
    """Simulator parameters of the effect at a strength (0 to 1) on the machine `base`."""
    f, v, d = scale.force, scale.speed, scale.size
    level, inertia, s = base.get("level", 0.0), base["inertia"], strength
    a, b, turn = q["a"], q["b"], 2 * math.pi * q["c"]
    tip_inertia = (0.2 + 0.4 * a) * inertia
    if effect == "viscous":
        return {"damping": s * f / v}
    if effect == "coulomb":
        return {"level": 0.6 * s * f}
    if effect == "coulomb_asymmetry":
        return {"half_difference": q["sign"] * 0.6 * s * level}
    if effect == "stribeck":
        return {"extra_static_level": 1.2 * s * level, "stribeck_velocity": v * 0.03 * 10**a}
    if effect == "presliding":
        stiffness = level / max(0.5 * s * d, 1.5 * scale.resolution)
        # Dahl for one half of the draws, LuGre with up to half its critical damping for the other
        damping = max(2.0 * b - 1.0, 0.0) * math.sqrt(stiffness * inertia)
        return {"presliding": stiffness, "bristle_damping": damping}
    if effect == "bias":
        return {"bias": q["sign"] * 0.8 * s * f}
    if effect == "spring":
        return {"spring": s * f / d}
    if effect == "added_inertia":
        return {"added_inertia": 0.6 * s * inertia}
    if effect == "actuation_delay":
        return {"delay": 0.008 * s}
    if effect == "actuator_lag":
        return {"lag": 0.010 * s}
    if effect == "quadratic_drag":
        return {"drag": 0.6 * s * f / v**2}
    if effect == "viscous_asymmetry":
        return {"damping_difference": q["sign"] * 0.8 * s * base.get("damping", 0.0)}
    if effect == "position_dependent_friction":
        return {
            "level_wave": 0.8 * s,
            "level_wave_period": d * (1.5 + 3 * a),
            "level_wave_phase": turn,
        }
    if effect == "load_dependent_friction":
        return {"load_coefficient": 0.5 * s}
    if effect == "friction_drift":
        return {"drift_fraction": 0.8 * s, "drift_time": scale.duration * (0.2 + 0.8 * a)}
    if effect == "friction_memory":
        return {"memory_time": 0.08 * s}
    if effect == "hardening_spring":
        return {"hardening": 0.4 * s * f / d**3}
    if effect == "cogging":
        return {
            "cogging": 0.5 * s * f, "cogging_period": d * (0.4 + 1.6 * a), "cogging_phase": turn,
        }  # fmt: skip
    if effect == "transmission_compliance":
        stiffness = tip_inertia * (2 * math.pi * 12 / s) ** 2
    elif effect == "backlash":
        stiffness = tip_inertia * (2 * math.pi * (25 + 20 * b)) ** 2
    else:
        stiffness = 0.0
    if stiffness:
        damping = 2 * (0.03 + 0.1 * q["d"]) * math.sqrt(stiffness * tip_inertia)
        out = {"has_tip": 1.0, "tip_inertia": tip_inertia, "tip_stiffness": stiffness}
        gap = {"gap": 0.4 * s * d} if effect == "backlash" else {}
        return out | {"tip_damping": damping} | gap
    if effect == "actuator_saturation":
        return {"limit": f * 2.5 * math.exp(-2.2 * s)}
    if effect == "actuator_gain":
        return {"gain": 1 + q["sign"] * 0.4 * s}
    if effect == "torque_ripple":
        return {"ripple": 0.6 * s, "ripple_period": d * (0.5 + 2 * a), "ripple_phase": turn}
    if effect == "gravity":
        return {"gravity": 2.0 * s * f, "gravity_phase": turn}
    if effect == "maxwell_slip":
        # two or three elements: a stiff one, and softer ones that slip after a longer way
        slip_length, third = max(0.15 * s * d, 1.5 * scale.resolution), 0.25 if b > 0.5 else 0.0
        second = 0.3 + 0.2 * a
        return {
            "slip_k1": (1 - second - third) * level / slip_length,
            "slip_k2": second * level / (4.0 * slip_length), "slip_w2": second * level,
            "slip_k3": third * level / (14.0 * slip_length), "slip_w3": third * level,
            "slip_k4": 0.0, "slip_w4": 0.0,
        }  # fmt: skip
    if effect == "shear_thinning":
        power = 0.25 + 0.4 * a
        return {"thinning": 1.2 * s * f / v**power, "thinning_power": power}
    if effect == "contact_damping":
        return {"contact_damping": 0.05 * s * base["contact_stiffness"]}
    if effect == "contact_hardening":
        power = 1 + 0.9 * s
        return {
            "contact_power": power,
            "contact_stiffness": base["contact_stiffness"] * d ** (1 - power),
        }
    if effect == "outside_hum":
        return {"hum": 0.5 * s * f, "hum_frequency": 50.0 if a < 0.6 else 60.0, "hum_phase": turn}
    if effect == "outside_position_dependent_damping":
        return {"place_damping": s * f / (v * d * d)}
    if effect == "outside_slow_force":
        return {"slow_force": 0.5 * s * f, "slow_frequency": 0.1 + 0.3 * a}
    raise KeyError(effect)
