#!/usr/bin/python3
"""Reads every test result file. Fails on failures, errors, empty, unreadable and missing files.

Usage: check_results.py BUILD_DIRECTORY ROSTEST_DIRECTORY
"""
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree


def expected_files(build, rostests):
    """Names of the result files that the tests known to ctest must leave."""
    text = (build / "CTestTestfile.cmake").read_text()
    names = set(re.findall(r"test_results/haptic_cloth/([\w.-]+\.xml)", text))
    # The gtest inside a rostest has a result of its own, named by test-name.
    for launch in rostests.rglob("*.test"):
        stem = "_".join(launch.relative_to(rostests).with_suffix("").parts)
        if "rostest-test_ros_%s.xml" % stem in names:
            names.update("rosunit-%s.xml" % test
                         for test in re.findall(r'test-name="([^"]+)"', launch.read_text()))
    return names


def count(path):
    """Passed, failed and skipped test cases of one file."""
    passed = failed = skipped = 0
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        if case.find("failure") is not None or case.find("error") is not None:
            failed += 1
        elif (case.find("skipped") is not None or case.get("status") == "notrun"
              or case.get("result") in ("skipped", "suppressed")):
            skipped += 1
        else:
            passed += 1
    return passed, failed, skipped


def main(build, rostests):
    expected = expected_files(build, rostests)
    results = build / "test_results"
    found = {path.name: path for path in results.rglob("*.xml")}
    problems = ["no tests are known to ctest"] if not expected else []
    problems += ["missing result: %s" % name for name in sorted(expected - set(found))]
    passed = failed = skipped = 0
    for name, path in sorted(found.items()):
        try:
            numbers = count(path)
        except ElementTree.ParseError as error:
            problems.append("unreadable result: %s (%s)" % (path, error))
            continue
        if sum(numbers) == 0:
            problems.append("empty result: %s" % path)
        if numbers[1]:
            problems.append("%d failed in %s" % (numbers[1], path))
        if name.startswith("rostest-"):
            continue  # stands for the file of the test inside, which is counted
        passed, failed, skipped = (a + b for a, b in zip((passed, failed, skipped), numbers))
    for problem in problems:
        print(problem)
    print("%d tests passed, %d failed, %d skipped" % (passed, failed, skipped))
    return 1 if problems else 0


if __name__ == "__main__":
    if {"-h", "--help"} & set(sys.argv):
        print(__doc__)
        sys.exit(0)
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
