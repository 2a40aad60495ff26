# SPDX-License-Identifier: Apache-2.0
"""The rules for descriptions of command-line modules, and the command line that 3D Slicer makes.

Written from the documentation of the Slicer Execution Model and of CTK's command line modules.
"""

import re
import xml.etree.ElementTree as ElementTree

HEAD = [
    "category", "title", "description", "version", "documentation-url", "license", "contributor",
    "acknowledgements",
]
SIMPLE = {"boolean", "integer", "float", "double", "string"}
ENUMERATIONS = {"string-enumeration", "integer-enumeration", "double-enumeration"}
FILES = {"image", "geometry"}
FOLDERS = {"directory"}
# The order of the elements of a parameter. One of flag, longflag and index is expected.
ORDER = [
    "name", "flag", "longflag", "index", "description", "label", "default", "channel",
    "constraints", "element",
]
ATTRIBUTES = {
    "image": {"type": {"scalar", "label", "vector", "tensor", "diffusion-weighted"}},
    "geometry": {"fileExtensions": None, "type": {"model", "fiberbundle"}},
}


def _problems_of_parameter(tag, names, flags):
    kind = tag.tag
    name = tag.findtext("name") or ""
    where = f"<{kind}> {name}"
    if kind not in SIMPLE | ENUMERATIONS | FILES | FOLDERS:
        yield f"{where}: unknown type"
    children = [child.tag for child in tag]
    places = [ORDER.index(child) if child in ORDER else -1 for child in children]
    if -1 in places or places != sorted(places):
        yield f"{where}: elements {children}, expected some of {ORDER} in this order"
    for child in set(children) - {"element"}:
        if children.count(child) > 1:
            yield f"{where}: several <{child}>"
    if not re.fullmatch("[_a-zA-Z][_a-zA-Z0-9]*", name) or name in names:
        yield f"{where}: the name is no identifier, or is used twice"
    names.add(name)
    for child in ("description", "label"):
        if not (tag.findtext(child) or "").strip():
            yield f"{where}: no {child}"
    channel = tag.findtext("channel", "input")
    is_result = channel == "output" and kind not in FILES | FOLDERS
    places = [child for child in ("flag", "longflag", "index") if tag.find(child) is not None]
    # Slicer takes an output without a flag and without an index as a returned value.
    if len(places) != (0 if is_result else 1):
        yield f"{where}: has {places}, expected {'none' if is_result else 'one of flag and index'}"
    flag = tag.findtext("longflag")
    if flag is not None:
        if not re.fullmatch("-?-?[_a-zA-Z][_a-zA-Z0-9]*", flag) or flag in flags:
            yield f"{where}: flag '{flag}' is no flag, or is used twice"
        flags.add(flag)
    if kind in FILES | FOLDERS and "channel" not in children:
        yield f"{where}: no channel"
    elements = [element.text for element in tag.findall("element")]
    if (kind in ENUMERATIONS) != bool(elements):
        yield f"{where}: elements {elements}"
    yield from _problems_of_default(tag, where, elements, is_result)
    for key, value in tag.attrib.items():
        allowed = ATTRIBUTES.get(kind, {}).get(key, set())
        if allowed is not None and value not in allowed:
            yield f"{where}: attribute {key}={value!r}"


def _problems_of_default(tag, where, elements, is_result):
    kind, default = tag.tag, tag.findtext("default")
    # Slicer passes every number and every word of an enumeration, so it needs a default.
    if default is None:
        if kind not in FILES | FOLDERS | {"string"} and not is_result:
            yield f"{where}: no default"
        return
    patterns = {
        "boolean": "true|false",
        "integer": r"-?\d+",
        "float": r"-?\d+(\.\d+)?",
        "double": r"-?\d+(\.\d+)?",
    }
    is_element = not elements or default in elements
    if not re.fullmatch(patterns.get(kind, ".*"), default) or not is_element:
        yield f"{where}: default '{default}'"


def problems(text):
    """What is wrong with a description, one line each."""
    if not text.startswith("<?xml"):
        return ["it does not start with <?xml"]
    root = ElementTree.fromstring(text)
    found = []
    if root.tag != "executable":
        found.append(f"the root is <{root.tag}>, expected <executable>")
    head = [child.tag for child in root if child.tag != "parameters"]
    if head != HEAD or [child.tag for child in root][: len(HEAD)] != HEAD:
        found.append(f"head {head}, expected {HEAD}")
    for child in ("title", "description"):
        if not (root.findtext(child) or "").strip():
            found.append(f"no {child}")
    names, flags = set(), set()
    groups = root.findall("parameters")
    for group in groups:
        children = [child.tag for child in group]
        if children[:2] != ["label", "description"] or len(children) < 3:
            found.append(f"group with {children[:3]}, expected label, description, parameters")
        is_advanced = group.get("advanced", "true")
        if set(group.attrib) - {"advanced"} or is_advanced not in ("true", "false"):
            found.append(f"group with attributes {group.attrib}")
        for tag in group[2:]:
            found.extend(_problems_of_parameter(tag, names, flags))
    indices = sorted(int(tag.text) for tag in root.iter("index"))
    if not groups or indices != list(range(len(indices))):
        found.append(f"indices {indices}, expected 0, 1, ...")
    return found


def command_line(module, files, values, returned=None):
    """The words that 3D Slicer passes to a module.

    Flags are in the order of the panel. Numbers and words of enumerations are always passed,
    strings and folders if they are not empty, booleans if they are true; files with an index come
    last.

    Parameters
    ----------
    module : ctk_cli.CLIModule
    files : dict of the files by the name of the parameter
    values : dict of the values that the user changed
    returned : path of the file of returned values, if the module has some
    """
    unknown = set(values) - {parameter.name for parameter in module.parameters()}
    assert not unknown, unknown
    arguments, options, outputs = module.classifyParameters()
    words = [] if not outputs else ["--returnparameterfile", str(returned)]
    for parameter in options:
        value = values.get(parameter.name, parameter.default)
        if parameter.typ == "boolean":
            words += [parameter.longflag] if value in (True, "true") else []
        elif parameter.typ not in ("string", "directory") or value:
            words += [parameter.longflag, str(value)]
    return words + [str(files[parameter.name]) for parameter in arguments]
