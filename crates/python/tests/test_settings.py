"""Settings: every keyword argument has the name, default and error sentence of its flag."""

import inspect
import re

import pytest

import asperity as asp
from asperity import _core
from asperity._call import Call, settings

COMMANDS = ["generate", "inspect", "mesh", "trace", "render", "verify", "map", "gonio", "albedo", "converge",
            "attenuation", "model", "materials", "export", "report", "merge"]
FUNCTIONS = {name: getattr(asp, name) for name in
             ["trace", "verify", "map", "gonio", "albedo", "converge", "attenuation"]}


def program(capfd, *arguments):
    """Exit code and both outputs of the program, run in this process."""
    code = _core.main(["asperity", *arguments])
    return code, *capfd.readouterr()


@pytest.mark.parametrize("command", COMMANDS)
def test_every_flag_of_the_help_is_an_argument_with_its_default(command, capfd):
    _, help, _ = program(capfd, command, "--help-all")
    flags = set(re.findall(r"^ +(?:-\w, )?--([a-z-]+)", help, re.MULTILINE))
    of_terminals = {"help", "help-all", "quiet", "verbose", "json", "report", "list"}
    known = {setting["flag"]: setting for setting in settings(command)}
    assert flags - of_terminals == set(known)
    entries = re.split(r"^ +(?:-\w, )?--(?=[a-z])", help, flags=re.MULTILINE)[1:]
    texts = {re.match("[a-z-]+", entry)[0]: " ".join(entry.split()) for entry in entries}
    for flag, setting in known.items():
        if setting["default"] is not None and setting["kind"] != "switch":
            assert f"{setting['default']}]" in texts[flag] or setting["default"] in texts[flag], flag


@pytest.mark.parametrize("name", FUNCTIONS)
def test_signatures_and_documentation_have_every_setting(name):
    parameters = inspect.signature(FUNCTIONS[name]).parameters
    for setting in settings(name):
        assert setting["name"] in parameters
        if setting["name"] not in ("output", "threads", "surface"):
            assert f"\n{setting['name']}\n" in FUNCTIONS[name].__doc__


@pytest.mark.parametrize("command", COMMANDS)
def test_every_refusal_has_the_sentence_of_the_command_line(command, capfd):
    for setting in settings(command):
        if setting["kind"] == "switch":
            continue
        flag, name = setting["flag"], setting["name"]
        positional = [] if command in ("generate", "verify", "map", "gonio", "albedo", "converge", "attenuation") else ["x"]
        code, _, told = program(capfd, command, *positional, f"--{flag}", "?!")
        if code != 2 or f"--{flag} ?!" not in told:
            continue
        with pytest.raises(ValueError) as refused:
            Call(command, {name: "?!"}, positional=positional).run(progress=False)
        sentence = told.removeprefix("asperity: ").strip()
        for other in sorted({s["flag"] for s in settings(command)}, key=len, reverse=True):
            sentence = sentence.replace(f"--{other} ?!", f"{known(command, other)}=?!")
        sentence = re.sub(r"--([a-z][a-z-]*)", lambda found: found[1].replace("-", "_"), sentence)
        assert str(refused.value) == sentence


def known(command, flag):
    return next(setting["name"] for setting in settings(command) if setting["flag"] == flag)


def test_most_settings_are_refused_by_their_value():
    """The test above compares something: values of most settings are refused before all else."""
    refused = 0
    for setting in settings("verify"):
        if setting["kind"] in ("number", "length", "count", "pair"):
            with pytest.raises(ValueError, match=rf"^{setting['name']}=\?!: must be"):
                asp.verify(**{setting["name"]: "?!"})
            refused += 1
    assert refused > 25
