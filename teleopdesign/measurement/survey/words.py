"""Words in names of columns, by what they say beyond the quantity (`column_names.WORDS`)."""

from __future__ import annotations

from ..column_names import has_word, words_of

#: what words say -> the words, in the languages that `column_names` reads
SAYS: dict[str, tuple[str, ...]] = {
    kind: tuple(words.split())
    for kind, words in {
        # of a motor; "iq" makes the torque of a brushless one
        "current": "current curr cur strom courant corriente corrente i iq amps 電流 电流 전류 ток",
        # drives a motor against its speed
        "voltage": "voltage volts spannung uq vq",
        "torque": "torque moment drehmoment couple coppia force kraft fuerza forza tau "
        "トルク 力矩 扭矩 토크 момент сила",
        # a torque about an axis that turns
        "turning torque": "torque torques drehmoment moment couple coppia tau effort iq "
        "トルク 力矩 扭矩 토크 момент",
        # the motor side of a gear
        "motor side": "motor motors moteur モータ 电机 мотор",
        # parts that have a position, a speed and a force
        "part": "motor servo axis joint",
        # drives that report positions in turns; joints of limbs turn, also where they lift
        "drive in turns": "odrive moteus",
        "limb": "shoulder elbow wrist hip knee ankle",
        "angle": "angle winkel theta phi angulo angolo 角度 각도 угол",
        "turning": "q enc encoder joint motor servo rotor wheel shaft",
        # parts that slide, in names without an angle: "torso_lift_joint" is a joint that slides
        "sliding": "lift elevator slide slider prismatic linear rail carriage",
        # what a controller puts out, beside the words of a command
        "output": "u control ctrl controller output out input action pwm duty set "
        "commanded commands request requested",
        "counter": "enc encoder count counts counter ticks tick inc",
        # the clock of a microcontroller, and the time from one row to the next
        "clock": "tick systick clock uptime",
        "step of time": "dt timestep deltat δt",
        "acceleration": "acceleration accel acc beschleunigung acceleracion qdd ddq xdd ddx qddot "
        "ddtheta",
        # such as the error of a controller: "q_err", "Schleppfehler"
        "difference": "error err fehler abweichung deviation erreur ecart errore 误差 誤差 偏差 "
        "오차 ошибка",
        # a length or a place along a line
        "length": "position pos x weg displacement displ disp stroke slider verschiebung "
        "deplacement",
    }.items()
}


def says(name: str, *kinds: str) -> bool:
    """Whether a name contains a word that says one of these: "Motorstrom" says "current"."""
    return any(has_word(name, SAYS[kind]) for kind in kinds)


def says_only(name: str, kind: str) -> bool:
    """Whether a name has no other words: "motor" tells a part, and no quantity of it."""
    return bool(words_of(name)) and set(SAYS[kind]).issuperset(words_of(name))
