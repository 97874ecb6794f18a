#!/usr/bin/env python3
"""scansion_bench rank-coproc: good, malformed and out-of-range requests. coproc_test.py BENCH RECORDED.xyz"""
import re
import subprocess
import sys


def main():
    bench, scan = sys.argv[1:3]
    lines, inside = [], False
    for row in open(scan, encoding="ascii"):
        if row.startswith("#"):
            continue
        if not row.strip():
            inside = False
        elif inside:
            lines[-1] += 1
        else:
            lines.append(1)
            inside = True
    total = sum(lines)
    good = {
        f"run 0 {len(lines)} -1": total,
        "run 1 1 -0.5": lines[1],
        f"  run\t{len(lines) - 1}  1 -1 ": lines[-1],
        "run 0 2 1e9": 4,
        f"run 0 {len(lines)} 0.05": None,
        f"run 0 {len(lines)} 0.005": None,
    }
    bad = ["", "run", "run 0", "run 0 1", "run 0 1 x", "run 0 1 nan", "run 0 1 inf", "run 0 1 0.05 more", "run -1 1 0", "run 0.5 1 0",
           "run 0 0 0", f"run {len(lines)} 1 0", f"run 0 {len(lines) + 1} 0", "run 1 18446744073709551615 0",
           "run 99999999999999999999 1 0", "stop", "RUN 0 1 0"]
    with subprocess.Popen([bench, "rank-coproc", scan], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as coproc:
        def ask(request):
            coproc.stdin.write(request + "\n")
            coproc.stdin.flush()
            return coproc.stdout.readline()

        assert coproc.stdout.readline() == "ready\n"
        kept = {}
        for request, expected in good.items():
            for word in bad[:3]:
                assert re.fullmatch(r"error .+\n", ask(word)), word
            answer = ask(request)
            match = re.fullmatch(r"ns (\d+) kept (\d+)\n", answer)
            assert match, f"{request!r}: {answer!r}"
            kept[request] = int(match[2])
            assert int(match[1]) > 0
            assert expected is None or kept[request] == expected, f"{request!r}: {answer!r}, expected {expected}"
        for request in bad:
            answer = ask(request)
            assert re.fullmatch(r"error .+\n", answer), f"{request!r}: {answer!r}"
        coarse, fine = (kept[f"run 0 {len(lines)} {eps}"] for eps in ("0.05", "0.005"))
        assert 2 * len(lines) <= coarse < fine < total, (coarse, fine, total)
        assert re.fullmatch(r"ns \d+ kept \d+\n", ask("run 0 1 0")), "the last request before the end"
        coproc.stdin.close()
        assert coproc.stdout.read() == ""
        assert coproc.wait(30) == 0, coproc.returncode
    missing = subprocess.run([bench, "rank-coproc", scan + ".none"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert missing.returncode != 0 and missing.stdout == "" and "scansion_bench:" in missing.stderr, missing
    print(f"{len(good)} answers, {len(bad)} refusals")


if __name__ == "__main__":
    main()
