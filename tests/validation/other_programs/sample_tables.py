"""What a comparison needs to know about a sample, from its own records: Zemax's, CODE V's, Optiland's or
rayoptics'.

A table is a dict: `surfaces` (the object first, the image last), each with its type, its glass as the file names it and
whether it is the stop; the primary wavelength (nm), the unit (mm), the number of fields (None: not said). This is no reader of
lenses: it knows just enough to check what the programs say.
"""
import json, re

MM_PER_UNIT = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "METER": 1000.0, "M": 1.0, "C": 10.0, "I": 25.4}
CODE_V_TYPES = {"SPH": "STANDARD", "CON": "STANDARD", "ASP": "EVENASPH"}
CODE_V_FIELDS = {"XAN", "YAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"}


def surface():
    return {"type": "STANDARD", "glass": None, "stop": False}


def read_zemax(text):
    table = {"surfaces": [], "unit_mm": 1.0, "fields": None}
    wavelengths, primary = {}, 1
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "SURF":
            table["surfaces"].append(surface())
        elif words[0] == "UNIT":
            table["unit_mm"] = MM_PER_UNIT[words[1]]
        elif words[0] == "FTYP":
            table["fields"] = int(words[3]) or None
        elif words[0] == "WAVM":
            wavelengths[int(words[1])] = 1000 * float(words[2])
        elif words[0] == "PWAV":
            primary = int(words[1])
        elif words[0] == "TYPE":
            table["surfaces"][-1]["type"] = words[1]
        elif words[0] == "GLAS":
            table["surfaces"][-1]["glass"] = words[1]
        elif words[0] == "STOP":
            table["surfaces"][-1]["stop"] = True
    return {**table, "wavelength_nm": wavelengths[primary]}


def code_v_statements(text):
    """Lists of words: commands end at a line's end or a semicolon, go on behind an ampersand, and "!" begins a remark.
    A word in quotes keeps them."""
    text = re.sub(r"&[ \t]*(![^\n]*)?\r?\n", " ", re.sub(r"!(?=(?:[^'\"\n]*['\"][^'\"\n]*['\"])*[^'\"\n]*$)[^\n]*", "",
                                                   text, flags=re.MULTILINE))
    for line in text.splitlines():
        words = []
        for word in re.findall(r"'[^']*'|\"[^\"]*\"|;|[^\s;]+", line):
            if word == ";":
                if words:
                    yield words
                words = []
            else:
                words.append(word)
        if words:
            yield words


def read_code_v(text):
    table = {"surfaces": [], "unit_mm": 1.0, "fields": 0}
    wavelengths, reference = [], 1
    for words in code_v_statements(text):
        key = words[0].upper()
        if re.fullmatch(r"S(O|I|\d*)", key):
            here = surface()
            if len(words) > 3 and words[3].upper() == "REFL":
                here["glass"] = "MIRROR"
            elif len(words) > 3:
                here["glass"] = words[3]
            table["surfaces"].append(here)
        elif key[:3] == "DIM":
            table["unit_mm"] = MM_PER_UNIT[words[1][0].upper()]
        elif key == "WL":
            wavelengths = [float(word) for word in words[1:]]
        elif key == "REF":
            reference = int(words[1])
        elif key in CODE_V_FIELDS:
            table["fields"] = max(table["fields"], len(words) - 1)
        elif key[:3] == "STO":
            table["surfaces"][int(words[1][1:]) if len(words) > 1 else -1]["stop"] = True
        elif key in CODE_V_TYPES:
            table["surfaces"][-1]["type"] = CODE_V_TYPES[key]
        elif key == "DIF":
            table["surfaces"][-1]["type"] = "DIF"
    if not any(each["stop"] for each in table["surfaces"]):
        table["surfaces"][1]["stop"] = True
    return {**table, "wavelength_nm": wavelengths[reference - 1]}


def read_optiland(text):
    content = json.loads(text)
    surfaces = []
    for each in content["surface_group"]["surfaces"]:
        material = each.get("material_post") or {}
        plain = each["geometry"]["type"] in ("Plane", "StandardGeometry")
        surfaces.append({**surface(), "type": "STANDARD" if plain else each["geometry"]["type"],
                         "glass": material.get("name"), "stop": bool(each.get("is_stop"))})
    primary = next(each for each in content["wavelengths"]["wavelengths"] if each["is_primary"])
    return {"surfaces": surfaces, "unit_mm": 1.0, "fields": len(content["fields"]["fields"]),
            "wavelength_nm": round(1000 * primary["value"], 9)}


RAYOPTICS_UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inches": 25.4}


def read_rayoptics(text):
    model = json.loads(text)["optical_model"]["attributes"]
    sequence, spec = model["seq_model"]["attributes"], model["optical_spec"]["attributes"]
    surfaces = []
    for i, each in enumerate(sequence["ifcs"]):
        own = each["attributes"]
        medium = sequence["gaps"][i]["attributes"]["medium"] if i < len(sequence["gaps"]) else {"__instance_type__": [0, "Air"]}
        element = (own.get("phase_element") or {"__instance_type__": [0, ""]})["__instance_type__"][1]
        surfaces.append({"type": "DIF" if element == "DiffractiveElement" else "STANDARD",
                         "glass": "MIRROR" if own["interact_mode"] == "reflect"
                         else None if medium["__instance_type__"][1] == "Air" else medium["attributes"].get("gname", f"n{i}"),
                         "stop": i == (sequence["stop_surface"] or 1)})
    region = spec["spectral_region"]["attributes"]
    return {"surfaces": surfaces,
            "unit_mm": RAYOPTICS_UNITS[model["system_spec"]["attributes"]["_dimensions"].lower()],
            "fields": len(spec["field_of_view"]["attributes"]["fields"]),
            "wavelength_nm": region["wavelengths"][region["reference_wvl"]]}


def read_table(file, text):
    form = file.suffix.lower()
    return {".zmx": read_zemax, ".seq": read_code_v, ".json": read_optiland, ".roa": read_rayoptics}[form](text)


def zemax_with_constants(text, gap_indices):
    """A glass without a name (___BLANK, n_d, V_d) as a constant: V_d = 0 is how Zemax says so. Others keep their
    names, which can be overridden."""
    number = -1
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if line.startswith("SURF"):
            number += 1
        if line.lstrip().startswith("GLAS ___BLANK "):
            lines[i] = re.sub(r"(GLAS ___BLANK \S+ \S+) \S+ \S+", rf"\g<1> {gap_indices[number]!r} 0", line)
    return "\n".join(lines) + "\n"


def code_v_with_constants(text, gap_indices):
    """Every glass as the index itself, which CODE V calls a fictitious glass without dispersion."""
    number = -1
    lines = []
    for words in code_v_statements(text):
        if re.fullmatch(r"S(O|I|\d*)", words[0].upper()):
            number += 1
            if len(words) > 3 and words[3].upper() != "REFL":
                words = [*words[:3], repr(gap_indices[number]), *words[4:]]
        lines.append(" ".join(words))
    return "\n".join(lines) + "\n"


def optiland_with_constants(text, gap_indices):
    content = json.loads(text)
    for each, index in zip(content["surface_group"]["surfaces"], gap_indices):
        if (each.get("material_post") or {}).get("type") not in (None, "Mirror"):
            each["material_post"] = {"type": "IdealMaterial", "index": index, "absorp": 0.0}
    return json.dumps(content)


def rayoptics_with_constants(text, gap_indices):
    content = json.loads(text)
    for gap, index in zip(content["optical_model"]["attributes"]["seq_model"]["attributes"]["gaps"], gap_indices):
        if gap["attributes"]["medium"]["__instance_type__"][1] != "Air":
            gap["attributes"]["medium"] = {"__instance_type__": ["opticalglass.opticalmedium", "ConstantIndex"],
                                           "attributes": {"label": "n", "n": index}}
    return json.dumps(content)


def with_constants(file, text, gap_indices):
    """The file's text with the indices that a program took, one for each gap, in place of glasses that have no name
    by which another index could be given."""
    form = file.suffix.lower()
    return {".zmx": zemax_with_constants, ".seq": code_v_with_constants,
            ".json": optiland_with_constants, ".roa": rayoptics_with_constants}[form](text, gap_indices)
