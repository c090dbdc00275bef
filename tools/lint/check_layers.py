#!/usr/bin/env python3
"""Fails when an include points the wrong way.

The order is the one CMake builds in: the foreach(folder ...) lists of common/CMakeLists.txt and
services/*/CMakeLists.txt, bottom to top. A folder may include itself and the folders before it; common/ includes no
service, services never include one another, and nothing of the product includes tests/ or tools/. Each third-party
library stays behind the folders named in LIBRARIES.

Usage: check_layers.py [ROOT]     prints one line for each wrong include; exit status 1 if there are any.
"""
import re
import sys
from pathlib import Path

# What an include starts with -> folders that may say so.
LIBRARIES = {
    "embree3/": ("services/view/render", "services/contact/bake"),
    "opencv2/": ("services/view/render",),
    "dds/": ("common/link", "idl"),
    "iceoryx": ("common/link",),
    "spdlog/": ("common/log",),
    "assimp/": ("services/contact/bake",),
    "toml++/": ("common/session",),
    "CLI/": ("tools/cli", "tools/bench", "tools/evidence", "common/service", "services/contact/bake"),
    "fcl/": ("tools/bench",),
    "openvdb/": ("tools/bench",),
}
SOURCES = {".hpp", ".h", ".cpp", ".c", ".cc", ".ipp"}
SERVICES = ("contact", "coupling", "view")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def order_of(cmake_lists):
    """Folders in build order, from the first foreach(folder ...) of a CMakeLists.txt."""
    match = re.search(r"foreach\(folder\s+([^)]*)\)", cmake_lists.read_text())
    if not match:
        raise SystemExit(f"{cmake_lists}: no foreach(folder ...) list to read the layers from")
    return match.group(1).split()


def folder_of(path):
    """The layer a file belongs to: common/rt, services/contact/bake, services/contact (its program), tools/cli."""
    parts = path.parts[:-1]
    if not parts:
        return ""
    if parts[0] == "services":
        return "/".join(parts[:3])
    return "/".join(parts[:2])


class Layers:
    def __init__(self, root):
        self.root = root
        self.orders = {"common": order_of(root / "common/CMakeLists.txt")}
        for service in SERVICES:
            self.orders["services/" + service] = order_of(root / "services" / service / "CMakeLists.txt")

    def resolve(self, file, name):
        """Path below the root of an include in our own tree; None for anything else."""
        for base in (file.parent, Path("common"), Path("services"), Path("tests"), Path("tools"), Path("")):
            candidate = (self.root / base / name).resolve()
            if candidate.is_file() and candidate.is_relative_to(self.root):
                return candidate.relative_to(self.root)
        return None

    def wrong_way(self, source, target):
        """Why folder `source` may not include folder `target`; None when it may."""
        if source == target or source.startswith(("tests", "tools")):
            return None
        if target.startswith(("tests", "tools")):
            return "the product does not include " + target.split("/")[0]
        source_top, target_top = self.top(source), self.top(target)
        if source_top == target_top:
            order = self.orders.get(source_top)
            inner, other = source[len(source_top) + 1:], target[len(target_top) + 1:]
            if not inner:  # a service's program, above all its folders
                return None
            if not other:
                return f"{source} lies below the program that includes it"
            for name, folder in ((inner, source), (other, target)):
                if order is not None and name not in order:
                    return f"{folder} is not in the order of {source_top}/CMakeLists.txt"
            if order is not None and order.index(other) > order.index(inner):
                return f"{target} is above {source}"
            return None
        if target_top == "common" or target_top == "idl":
            return None
        if source_top == "common":
            return "common includes no service"
        return "services never include one another"

    @staticmethod
    def top(folder):
        parts = folder.split("/")
        return "/".join(parts[:2]) if parts[0] == "services" else parts[0]

    def check(self, file):
        """Yields (line number, include, reason) for a file given relative to the root."""
        source = folder_of(file)
        free = source.startswith("tests")
        text = (self.root / file).read_text(errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            name = match.group(2)
            for prefix, allowed in LIBRARIES.items():
                if name.startswith(prefix) and not free and source not in allowed:
                    yield number, name, f"{prefix.rstrip('/')} belongs to {', '.join(allowed)}"
            target = self.resolve(file, name)
            if target is not None:
                reason = self.wrong_way(source, folder_of(target))
                if reason:
                    yield number, name, reason

    def run(self):
        wrong = 0
        count = 0
        for top in ("common", "services", "tools", "tests", "idl"):
            for path in sorted((self.root / top).rglob("*")):
                if path.suffix not in SOURCES or not path.is_file():
                    continue
                count += 1
                file = path.relative_to(self.root)
                for number, name, reason in self.check(file):
                    wrong += 1
                    print(f"{file}:{number}: {name}: {reason}")
        print(f"layers: {count} files, {wrong} wrong includes")
        return wrong


if __name__ == "__main__":
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[2]
    sys.exit(1 if Layers(root.resolve()).run() else 0)
