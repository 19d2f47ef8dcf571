"""What cannot be asked of `farhand ros2` is one line and exit code 2."""

import pytest

from farhand.cli import run


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--distro", "humble"], "has no type hashes"),
        (["--distro", "jazy"], "must be jazzy, kilted, lyrical"),
        (["--domain", "233"], "must be 0 to 232"),
        (["--domain", "-1"], "must be 0 to 232"),
        (["--namespace", "far hand"], "--namespace 'far hand': expected a slash"),
        (["--joy-topic", "joy"], "--joy-topic 'joy': expected a slash"),
        (["--side", "left"], "must be operator or robot"),
        (["--command-type", "m/s"], "must be speed_units or unitless"),
        (["--tool-frame", "base"], "is the base frame's name"),
        (["--joy-topic", "/"], "expected a topic's full name"),
        (["--joy", "deadman"], "--joy 'deadman': expected KEY=VALUE such as deadman=button4"),
        (["--connect", "tls/127.0.0.1:7446", "--tls", "certs"], "reports stay on its host"),
        (["--joy", "deadman="], "must name a button"),
        (["--joy", "x=stick1"], "no such input: 'stick1'"),
        (["--joy", "jump=button1"], "jump"),
        (["--robot", "a/b"], "a robot's name"),
        (["--connect", "tcp/10.0.0.1:7446"], "must be on this host"),
        (["--router", "7447"], "expected PROTOCOL/HOST:PORT"),
        (["--router", "tls/127.0.0.1:7447"], "needs --tls DIR"),
        (["--tls", "certs"], "--tls certs: no endpoint is secured"),
        (["--tls", "certs", "--router", "tls/127.0.0.1:7447"], "there is no ca.pem"),
        (["no-such-run.mcap"], "no such file"),
    ],
)
def test_what_cannot_be_is_one_line_and_code_2(arguments, words, capsys):
    assert run(["ros2", *arguments]) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
