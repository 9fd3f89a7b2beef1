"""Message about a model that MuJoCo refuses: its element and line, what is wrong, and what to do."""

import re
from xml.etree import ElementTree

import mujoco

_LEAD = re.compile(r"^(?:XML Error: |Error: |Schema violation: )+")
_ELEMENT = re.compile(r" ?Element (?:name )?'([^']*)'(?:, id -?\d+)?(?:, line (\d+))?")
# parts of MuJoCo's messages, and what to do about each; the first that a message holds counts
_REMEDIES = (
    ("opening file", "Put the file there, or correct its name; it is looked for from the model's folder on."),
    ("mjMINVAL", "Give this body mass: a geom, or an <inertial>."),
    ("decoder", "Export or copy this file again."),
    (
        "repeated name",
        "Give each element of a kind its own name; body/NAME, point/NAME, mount/NAME and wirerope/... are added to each model.",
    ),
    ("model type", "An MJCF file begins with <mujoco>."),
    ("not found", "Name one that the model has, or add it."),
    ("unknown", "Name one that the model has, or add it."),
    ("unrecognized name", "Name one that the model has, or add it."),
)
_REMEDY = "What each element may hold: https://mujoco.readthedocs.io/en/stable/XMLreference.html."


def refused(reason: str, text: str) -> str:
    """Return the message about an MJCF text that MuJoCo refused for a `reason`, which never says what to do."""
    reason = " ".join(reason.split())
    if "XML parse error" in reason:
        return _not_xml(text)
    element = _ELEMENT.search(reason)
    name, line = element.groups() if element else ("", None)
    included = " of it or of a file that it includes" if "<include" in text else ""
    location = ", ".join(filter(None, [name and f"element {name!r}", line and f"line {line}{included}"]))
    problem = (
        _LEAD.sub("", _ELEMENT.sub("", reason)).rstrip(". ").replace("mjMINVAL", f"{mujoco.mjMINVAL:g} kg and kg m^2")
    )
    remedy = next((remedy for key, remedy in _REMEDIES if key in reason), _REMEDY)
    return f"MuJoCo cannot compile the model: {': '.join(filter(None, [location, problem]))}. {remedy}"


def _not_xml(text: str) -> str:
    location = "a file that it includes"
    try:
        ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        location = f"line {error.position[0]}, column {error.position[1] + 1}"
    return (
        f"MuJoCo cannot compile the model: {location} is not well-formed XML. Write & as &amp; and < as &lt;, close every "
        "element, and give no attribute twice."
    )
