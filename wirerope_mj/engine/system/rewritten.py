"""The MJCF of a variant that has other isolators, other places of its mounts and other limits than the model as written."""

from xml.etree import ElementTree as ET

from wirerope_mj.engine.system.on_deck import model_root, written
from wirerope_mj.engine.system.system import System, load_system
from wirerope_mj.foundation.errors import ModelError


def with_part(system: System, mounts: list[str], name: str) -> str:
    """Write the MJCF of a variant in which some mounts, all of one isolator, have it as isolators/NAME.toml.

    A ModelError if the model names files beside it, or attaches parts whose sites do not stand in its own text.
    """
    plain = load_system(system.path or system.mjcf, isolators=system.isolators)
    root, model, before = model_root(system), system.model, plain.model
    custom = root.find("custom")
    sites = {site.get("name", ""): site for site in root.iter("site")}
    tuples = {one.get("name", ""): one for one in root.iter("tuple")}
    for mount in mounts:
        for site in (system.mounts[mount].payload_site, system.mounts[mount].base_site):
            shift = model.site(site).pos - before.site(site).pos
            if site not in sites or f"mount/{mount}" not in tuples or custom is None:
                raise ModelError(f"mount {mount!r} does not stand in the model's own text: write its model by hand.")
            place = [float(one) for one in sites[site].get("pos", "0 0 0").split()] + shift
            sites[site].set("pos", " ".join(f"{one + 0.0:.12g}" for one in place))
        for element in tuples[f"mount/{mount}"].iter("element"):
            if element.get("objtype") == "text":
                element.set("objname", f"isolator/{name}")
    assert custom is not None
    used = {one.get("objname") for one in root.iter("element")}
    for text in [one for one in custom.findall("text") if one.get("name", "").startswith("isolator/")]:
        if text.get("name") not in used or text.get("name") == f"isolator/{name}":
            custom.remove(text)
    ET.SubElement(custom, "text", name=f"isolator/{name}", data=f"isolators/{name}.toml")
    for limit in system.limits:
        key = f"limit/{limit.kind}/{limit.name}"
        for old in [one for one in custom.findall("numeric") if one.get("name") == key]:
            custom.remove(old)
        ET.SubElement(custom, "numeric", name=key, data=" ".join(f"{value:.12g}" for value in limit.values))
    return written(root)
