# What the peers have in common: told by lines what to do, they answer by lines, as bench_peers.h says.
# Their own part, which follows this text, ends with a call of serve().
import gc, os, sys, time

answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what libraries print is no answer
threads = int(sys.argv[1])


def answer(*words):
    print(*words, file=answers, flush=True)


def without(kind, error, trace):
    if issubclass(kind, ImportError):
        answer("missing", error.name)
    else:
        sys.__excepthook__(kind, error, trace)


sys.excepthook = without
import numpy


def use_few_processors():
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])


# As study/memory.c does it: the kernel's count of the most that was held begins anew.
def held(key):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith(key))


def held_before():
    gc.collect()
    try:
        import ctypes

        ctypes.CDLL(None).malloc_trim(0)
        with open("/proc/self/clear_refs", "w") as refs:
            refs.write("5")
    except (OSError, AttributeError):
        return None
    return held("VmRSS:")


def volume_of(kind, *sizes):
    return numpy.fromfile("volume", kind).reshape([int(n) for n in sizes[::-1]])


def mesh_of(vertices, triangles):
    numbers = open("mesh", "rb")
    points = numpy.fromfile(numbers, "f4", 3 * int(vertices)).reshape(-1, 3)
    return points, numpy.fromfile(numbers, "u4", 3 * int(triangles)).reshape(-1, 3)


def save(points, normals, triangles):
    with open("result", "wb") as out:
        numpy.ascontiguousarray(points, "f4").tofile(out)
        if normals is not None:
            numpy.ascontiguousarray(normals, "f4").tofile(out)
        numpy.ascontiguousarray(triangles, "u4").tofile(out)
    return len(points), len(triangles), int(normals is not None)


# prepare  by the first word of a line: takes the others, returns what is to be run and timed
# arrays   of what that returned: points, normals (None: none) and triangles
def serve(version, prepare, arrays):
    work = result = None
    answer("ready", version)
    for line in sys.stdin:
        word, *words = line.split()
        if word == "run":
            result = None
            before = held_before()
            start = time.perf_counter()
            result = work()
            seconds = time.perf_counter() - start
            answer("ok", seconds, max(held("VmHWM:") - before, 0) if before else 0)
        elif word == "save":
            answer("ok", *save(*arrays(result)))
        else:
            work = result = None
            work = prepare[word](*words)
            answer("ok")
