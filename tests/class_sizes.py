#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts the public functions and the data members of the classes of belief, experiment, record, gp and solids, and fails
if one has more than MOST_FUNCTIONS or MOST_MEMBERS.

    python3 tests/class_sizes.py [--all]      --all prints every class with both numbers

Public functions are counted with their overloads, without constructors, destructors and operators. Data members of
nested structs count as members of the class; constants do not. Structs of options (`: Options`) and structs without
functions are lists, and are left out.
"""
import pathlib
import re
import sys

MOST_FUNCTIONS, MOST_MEMBERS = 20, 15
FOLDERS = ["framework/experiment", "framework/record", "framework/belief", "plugins/beliefs/solids", "framework/gp"]
HEAD = re.compile(r"\b(class|struct)\s+(?:\[\[[^\]]*\]\]\s*)?(\w+)\s*(final)?\s*(:[^;{]*)?$")


def plain(text):
    """Returns the text without comments, literals, preprocessor lines and template argument lists."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.S)
    text = re.sub(r'"(?:\\.|[^"\\])*"', '""', text)
    text = re.sub(r"'(?:\\.|[^'\\])'", "0", text)
    text = re.sub(r"^[ \t]*#[^\n]*", "", text, flags=re.M)
    while True:
        shorter = re.sub(r"(\w)\s*<[^<>;{}()]*(?:\([^<>;{}()]*\))?[^<>;{}()]*>", r"\1", text)
        if shorter == text:
            return text
        text = shorter


def statements(body):
    """Yields the statements of a class's body with the text of their braces: ('int size() const', '{...}')."""
    depth = round_depth = 0
    head, block = "", ""
    for char in body:
        if char == "{":
            depth += 1
        if depth:
            block += char
        else:
            head += char
        if char in "()":
            round_depth += 1 if char == "(" else -1
        if char == "}":
            depth -= 1
            is_definition = "(" in head or HEAD.search(head.strip())
            if depth == 0 and is_definition and round_depth == 0 and not HEAD.search(head.strip()):
                # A function's body, unless this is an initialiser in its head.
                if re.search(r"(\)|const|override|noexcept|final)\s*$|\)\s*(const)?\s*:", head):
                    yield head.strip(), block
                    head, block = "", ""
        if char == ";" and depth == 0 and round_depth == 0:
            yield head.rstrip("; \n\t").strip(), block
            head, block = "", ""


def measure(body, access):
    """Returns the public functions, the data members, and the nested classes of a body."""
    functions = members = 0
    nested = []
    for head, block in statements(body):
        while match := re.match(r"(public|private|protected)\s*:(?!:)\s*", head):
            access = match[1]
            head = head[match.end():]
        head = re.sub(r"^template\s*(<[^>]*>)?\s*(class|typename)?[\w\s,]*?(?=\b(void|bool|int|auto|std|\w+)\b)", "", head)
        if not head or re.match(r"(using|friend|typedef|enum|static_assert)\b", head):
            continue
        match = HEAD.search(re.sub(r"\}.*$", "", head)) if block else None
        if match and "(" not in head.split(":")[0]:
            inner = measure(block[1:-1], "public" if match[1] == "struct" else "private")
            nested.append((match[2], *inner[:2]))
            members += inner[1]
            continue
        if re.search(r"(^|[^=])\w+\s*\(", head.split("=")[0]) or "operator" in head:
            name = re.search(r"([~\w]+)\s*\(", head)
            if access == "public" and name and "operator" not in head and not name[1].startswith("~"):
                functions += 1 if re.match(r".*\S\s+[&*]*\w+\s*\(", head, re.S) and not re.match(
                    r"(explicit\s+)?(\w+)\s*\(", head) else 0
            continue
        if re.match(r"(static\s+)?constexpr|static\b", head):
            continue
        members += head.count(",") + 1
    return functions, members, nested


def classes(file):
    text = plain(file.read_text())
    at = 0
    while match := re.compile(r"\b(class|struct)\s+(\w+)\s*(?:final)?\s*(:[^;{]*)?\{").search(text, at):
        depth, end = 1, match.end()
        while depth:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        at = end
        if "Options" in (match[3] or ""):
            continue
        functions, members, _ = measure(text[match.end():end - 1], "public" if match[1] == "struct" else "private")
        if match[1] == "class" or functions:
            yield match[2], functions, members


root = pathlib.Path(__file__).resolve().parent.parent
failed = False
for folder in FOLDERS:
    for file in sorted((root / folder).glob("*.hpp")):
        for name, functions, members in classes(file):
            beyond = functions > MOST_FUNCTIONS or members > MOST_MEMBERS
            failed = failed or beyond
            if "--all" in sys.argv:
                print(f"{functions:3} {members:3} {name:24} {file.relative_to(root)}")
            elif beyond:
                print(f"{file.relative_to(root)}: {name} has {functions} public functions and {members} data members, "
                      f"{MOST_FUNCTIONS} and {MOST_MEMBERS} are the limits: split it")
sys.exit(1 if failed else 0)
