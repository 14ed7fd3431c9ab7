"""The checks in scripts/ are themselves checked: each must pass a good sample and name what is wrong in a bad one.

    checks.py COMPILER
"""

import pathlib
import stat
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
COMPILER = sys.argv.pop(1) if len(sys.argv) > 1 else "c++"


class Sample(unittest.TestCase):
    """A folder of small files that lives as long as one test."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def write(self, path, *lines):
        file = self.folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return file

    def run_script(self, name, *arguments):
        done = subprocess.run([sys.executable, SCRIPTS / name, *map(str, arguments)], capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout

    def accepted(self, name, *arguments):
        status, output = self.run_script(name, *arguments)
        self.assertEqual(status, 0, output)

    def refused(self, text, name, *arguments):
        status, output = self.run_script(name, *arguments)
        self.assertEqual(status, 1, output)
        self.assertIn(text, output)


class Layers(Sample):
    def test_upward_includes_are_accepted(self):
        self.write("cdem/stress/love_weber.hpp", "#include <cdem/network/bonds.hpp>", "#include <cdem/core/types.hpp>",
                   "#include <cdem/stress/halo.hpp>", "#include <vector>")
        self.write("cdem/network/kd_tree.hpp", "#include <nanoflann.hpp>")
        self.write("cdem/cdem.hpp", "#include <cdem/stress/love_weber.hpp>")
        self.accepted("check_layers", self.folder)

    def test_downward_include_is_named_with_its_line(self):
        self.write("cdem/core/types.hpp", "#pragma once", "#include <cdem/geometry/box.hpp>")
        self.refused("cdem/core/types.hpp:2: <cdem/geometry/box.hpp>: geometry stands below core", "check_layers",
                     self.folder)

    def test_sibling_include_is_named(self):
        for line in ("#include <cdem/bond/beam.hpp>", "  #  include <cdem/bond/beam.hpp> // why not"):
            self.write("cdem/stress/love_weber.hpp", line)
            self.refused("love_weber.hpp:1: <cdem/bond/beam.hpp>: stress and bond are siblings", "check_layers",
                         self.folder)

    def test_headers_in_subfolders_are_seen(self):
        self.write("cdem/stress/tessellation/wedges.hpp", "#include <cdem/io/vtk.hpp>")
        self.refused("wedges.hpp:1: <cdem/io/vtk.hpp>: io stands below stress", "check_layers", self.folder)

    def test_other_faults(self):
        for line, answer in (('#include "types.hpp"', "write <cdem/...>"),
                             ("#include <cdem/cdem.hpp>", "is for users"),
                             ("#include <cdem/bonds/beam.hpp>", "'bonds' is not a layer"),
                             ("#include <nanoflann.hpp>", "kd_tree.hpp alone")):
            self.write("cdem/homogenize/moduli.hpp", line)
            self.refused(answer, "check_layers", self.folder)

    def test_unknown_folder_and_empty_folder(self):
        self.refused("no header", "check_layers", self.folder)
        self.write("cdem/utils/misc.hpp", "")
        self.refused("misc.hpp:1: stands in no layer", "check_layers", self.folder)


class Headers(Sample):
    def setUp(self):
        super().setUp()
        self.write("include/cdem/core/a.hpp", "#pragma once")
        self.write("include/cdem/core/detail/b.hpp", "#pragma once")
        self.write("include/cdem/cdem.hpp", "#pragma once", "#include <cdem/core/a.hpp>")
        self.listed = ["      include/cdem/core/a.hpp", "      include/cdem/core/detail/b.hpp",
                       "      include/cdem/cdem.hpp)"]
        self.write("CMakeLists.txt", *self.listed)

    def test_lists_that_agree_are_accepted(self):
        self.accepted("check_headers", self.folder)

    def test_header_in_no_list(self):
        self.write("include/cdem/core/c.hpp", "#pragma once")
        self.refused("CMakeLists.txt: include/cdem/core/c.hpp is missing", "check_headers", self.folder)
        self.refused("include/cdem/cdem.hpp: include/cdem/core/c.hpp is missing", "check_headers", self.folder)

    def test_listed_header_that_is_gone_or_twice(self):
        self.write("CMakeLists.txt", "      include/cdem/core/gone.hpp", *self.listed)
        self.refused("CMakeLists.txt: include/cdem/core/gone.hpp does not exist", "check_headers", self.folder)
        self.write("CMakeLists.txt", self.listed[0], *self.listed)
        self.refused("CMakeLists.txt: include/cdem/core/a.hpp stands twice", "check_headers", self.folder)

    def test_header_without_guard(self):
        self.write("include/cdem/core/a.hpp", "int a;")
        self.refused("a.hpp: does not start with #pragma once", "check_headers", self.folder)


class CompileFail(Sample):
    """A refusal counts only for the right reason, at the right line, in few words."""

    EXPECT = "// expect: Small"
    CONCEPT = "template <class T> concept Small = sizeof(T) < 8;"
    CLAIM = "static_assert(Small<Mine>); // refused here"

    def check(self, *lines):
        return "check_compile_fail", self.write("sample.cpp", *lines), "--", COMPILER, "-std=c++20"

    def mine(self, repaired="char c[4];", broken="char c[80];"):
        return "struct Mine {", "#ifdef CDEM_REPAIRED", repaired, "#else", broken, "#endif", "};"

    def test_right_refusal_is_accepted(self):
        self.accepted(*self.check(self.EXPECT, self.CONCEPT, *self.mine(), self.CLAIM))

    def test_file_that_compiles(self):
        self.refused("compiles, and must not", *self.check(self.EXPECT, self.CONCEPT, *self.mine(broken=""), self.CLAIM))

    def test_file_that_no_repair_helps(self):
        self.refused("does not compile when repaired",
                     *self.check(self.EXPECT, self.CONCEPT, *self.mine(repaired="char c[80];"), self.CLAIM))

    def test_refusal_elsewhere(self):
        self.refused("which is not marked", *self.check(self.EXPECT, self.CONCEPT, *self.mine(broken="Unknown c;"),
                                                         self.CLAIM))

    def test_second_error(self):
        self.refused("an error at sample.cpp:12, which is not marked",
                     *self.check(self.EXPECT, self.CONCEPT, *self.mine(), self.CLAIM, "#ifndef CDEM_REPAIRED",
                                 "Unknown more;", "#endif"))

    def test_message_without_the_expected_text(self):
        self.refused("does not contain 'Tiny'", *self.check("// expect: Tiny", self.CONCEPT, *self.mine(), self.CLAIM))

    def test_message_that_is_too_long(self):
        candidates = [f"struct Small{n} {{}}; void take(Small{n});" for n in range(12)]  # each is explained in turn
        long = ["#ifndef CDEM_REPAIRED", *candidates, "void call() { take(0); } // refused here", "#endif"]
        self.refused("lines, at most 19", *self.check(self.EXPECT, *long))

    def test_file_that_asks_for_nothing(self):
        self.refused("no line '// expect:", *self.check(self.CONCEPT, *self.mine(), self.CLAIM))
        self.refused("no line is marked", *self.check(self.EXPECT, self.CONCEPT))

    def test_several_refusals_in_one_file(self):
        second = ["// expect: Small<long>|T = long", "#ifndef CDEM_REPAIRED", "static_assert(Small<long>); // refused here", "#endif"]
        both = [self.EXPECT, self.CONCEPT, *self.mine(), self.CLAIM, *second]
        self.accepted(*self.check(*both))
        self.refused("0 errors at the user's line", *self.check(*[line.replace("Small<long>);", "true);") for line in both]))
        self.refused("does not contain 'Tiny'", *self.check(*[line.replace("T = long", "Tiny").replace("Small<long>|", "")
                                                             for line in both]))


class Snippets(Sample):
    """A page follows its source, and a page that does not is named."""

    def repository(self, *code, page=("<!-- region a.hpp one -->", "```cpp", "old", "```")):
        self.write("a.hpp", "// [one]", *code, "  // [one]")
        self.write("README.md", "")
        return self.write("docs/page.md", "text", *page, "more text")

    def test_page_is_renewed(self):
        page = self.repository("  int a;", "  // [two]", "    int b;")
        self.refused("a.hpp [one] has changed", "snippets", "--check", self.folder)
        self.accepted("snippets", self.folder)
        self.assertIn("-->\n```cpp\nint a;\n  int b;\n```\nmore", page.read_text())
        self.accepted("snippets", "--check", self.folder)

    def test_faults_of_pages_and_sources(self):
        self.repository("int a;", page=("<!-- region a.hpp two -->", "```cpp", "```"))
        self.refused("a.hpp has 0 lines '// [two]', 2 are expected", "snippets", "--check", self.folder)
        self.repository("int a;", page=("<!-- region a.hpp one -->", "no code"))
        self.refused("is not followed by a block of code", "snippets", "--check", self.folder)
        self.repository("int a;", page=("<!-- region b.hpp one -->", "```cpp", "```"))
        self.refused("b.hpp", "snippets", "--check", self.folder)


class BadOptions(Sample):
    """A stand-in for an example, which answers as it should or in one way that it should not."""

    GOOD = "sys.stderr.write(f'bad option or value: {sys.argv[1:]}\\n'); sys.exit(2)"
    HELP = "--quick --particles --seed --threads --out --packing --cache"

    def program(self, answer, help_text=HELP):
        file = self.write("program", f"#!{sys.executable}", "import sys",
                          f"if '--help' in sys.argv: print('{help_text}'); sys.exit(0)", answer)
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        return file

    def test_right_answer_is_accepted(self):
        self.accepted("check_bad_options", self.program(self.GOOD))

    def test_wrong_answers(self):
        for answer, fault in ((self.GOOD.replace("exit(2)", "exit(1)"), "exit status 1, 2 is expected"),
                              (self.GOOD.replace("\\n'", "\\nusage\\n'"), "2 lines on stderr"),
                              ("sys.stderr.write('no\\n'); sys.exit(2)", "is not in the answer"),
                              ("open('results.csv', 'w').close(); " + self.GOOD, "wrote results.csv")):
            self.refused(fault, "check_bad_options", self.program(answer))

    def test_help_without_an_option(self):
        self.refused("--help: does not exit with 0 and name --seed", "check_bad_options",
                     self.program(self.GOOD, self.HELP.replace("--seed", "")))


if __name__ == "__main__":
    unittest.main()
