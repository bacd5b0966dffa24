"""An identified model for a simulator, from an answer alone."""

from xml.etree import ElementTree

from teleopdesign.cli import main


def test_an_answer_becomes_mjcf_and_urdf_beside_it(answer, capsys):
    capsys.readouterr()
    for form, ending, tag in (("mjcf", ".xml", "mujoco"), ("urdf", ".urdf", "robot")):
        assert main(["export", str(answer), "--to", form]) == 0
        output = capsys.readouterr().out
        assert "device.coulomb.level" in output and "left out: stribeck at device" in output
        root = ElementTree.parse(answer.with_suffix(ending)).getroot()
        assert root.tag == tag and len(list(root.iter("joint"))) == 1


def test_a_file_of_another_ending_is_refused(answer, refused, tmp_path):
    line = refused("export", answer, "--to", "urdf", "--output", tmp_path / "rod.xml")
    assert "found '.xml', expected .urdf" in line
