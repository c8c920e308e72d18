"""What machine this is, and what else it does while it is measured. Linux; Python's own library only."""
import os
import pathlib
import resource
import subprocess
import time

CPUINFO = pathlib.Path("/proc/cpuinfo")
CACHES = pathlib.Path("/sys/devices/system/cpu/cpu0/cache")
# Names that VBOND_SIMD takes, and the flags that the processor must have for them
SETS = {"baseline": [], "avx2": ["avx2"], "avx512": ["avx512f", "avx512dq", "avx512vl"]}
FLAGS = ("avx2", "fma", "avx512f", "avx512dq", "avx512vl", "hypervisor")  # those that say something about speed

# Virtual machines often name the maker and no more, so it takes family and model to tell one generation from the next.
# Ranges of models: AMD's as in Linux's arch/x86/kernel/cpu/amd.c, Intel's as in arch/x86/include/asm/intel-family.h.
MICROARCHITECTURES = {
    ("AuthenticAMD", 23): {"Zen": [(0x00, 0x2f), (0x50, 0x5f)],
                           "Zen 2": [(0x30, 0x4f), (0x60, 0x7f), (0x90, 0x91), (0xa0, 0xaf)]},
    ("AuthenticAMD", 25): {"Zen 3": [(0x00, 0x0f), (0x20, 0x5f)], "Zen 4": [(0x10, 0x1f), (0x60, 0xaf)]},
    ("AuthenticAMD", 26): {"Zen 5": [(0x00, 0x2f), (0x40, 0x4f), (0x60, 0x7f)],
                           "Zen 6": [(0x50, 0x5f), (0x80, 0xaf), (0xc0, 0xcf)]},
    ("GenuineIntel", 6): {"Haswell": [(60, 60), (63, 63), (69, 70)],
                          "Broadwell": [(61, 61), (71, 71), (79, 79), (86, 86)],
                          "Skylake": [(78, 78), (94, 94)], "Skylake, Cascade Lake or Cooper Lake server": [(85, 85)],
                          "Kaby Lake or Coffee Lake": [(142, 142), (158, 158)], "Comet Lake": [(165, 166)],
                          "Ice Lake": [(106, 106), (108, 108), (125, 126)], "Tiger Lake": [(140, 141)],
                          "Rocket Lake": [(167, 167)], "Alder Lake": [(151, 151), (154, 154)],
                          "Raptor Lake": [(183, 183), (186, 186), (191, 191)], "Meteor Lake": [(170, 170), (172, 172)],
                          "Lunar Lake": [(189, 189)], "Arrow Lake": [(181, 181), (197, 198)],
                          "Sapphire Rapids": [(143, 143)], "Emerald Rapids": [(207, 207)],
                          "Granite Rapids": [(173, 174)], "Sierra Forest": [(175, 175)]},
}


def microarchitecture(vendor, family, model):
    for name, ranges in MICROARCHITECTURES.get((vendor, family), {}).items():
        if any(first <= model <= last for first, last in ranges):
            return name
    return "unknown"


def caches(folder):
    """Size in KiB of each cache of the first processor, such as {"L1 data": 48}; empty where Linux tells none."""
    sizes = {}
    for index in sorted(folder.glob("index*")):
        level, kind, size = ((index / name).read_text().strip() for name in ("level", "type", "size"))
        if kind != "Instruction":
            sizes[f"L{level}{' data' if kind == 'Data' else ''}"] = int(size.removesuffix("K"))
    return sizes


def processor(cpuinfo=CPUINFO, cache_folder=CACHES):
    """The first processor of this machine: what tells it from others, and what its speed depends on."""
    fields = {}
    for line in cpuinfo.read_text().splitlines():
        key, _, value = line.partition(":")
        fields.setdefault(key.strip(), value.strip())

    def whole(key):
        return int(fields[key]) if fields.get(key, "").isdigit() else None

    vendor, family, model = fields.get("vendor_id", ""), whole("cpu family"), whole("model")
    flags = fields.get("flags", "").split()
    return {"name": fields.get("model name") or os.uname().machine, "vendor": vendor, "family": family, "model": model,
            "stepping": whole("stepping"), "microarchitecture": microarchitecture(vendor, family, model),
            "flags": [flag for flag in FLAGS if flag in flags], "caches_KiB": caches(cache_folder)}


def processor_name(about):
    """Such as "AMD EPYC (Zen 5: AuthenticAMD family 26, model 2, stepping 1)"."""
    known = about["microarchitecture"] if about["microarchitecture"] != "unknown" else "unknown microarchitecture"
    numbers = ", ".join(f"{key} {about[key]}" for key in ("family", "model", "stepping") if about[key] is not None)
    return f"{about['name']} ({known}{': ' + about['vendor'] + ' ' + numbers if numbers else ''})"


def cache_sizes(about):
    return ", ".join(f"{name} {size // 1024} MiB" if size % 1024 == 0 else f"{name} {size} KiB"
                     for name, size in about["caches_KiB"].items())


def machine():
    return {"processor": processor(), "processors": os.cpu_count(), "system": " ".join(os.uname()[:3:2]),
            "date": time.strftime("%Y-%m-%d %H:%M:%S %z"), "load_average": os.getloadavg()}


def describe(at):
    """Lines that begin every table: a figure means nothing without them."""
    about = at["processor"]
    return (f"{processor_name(about)}\n{at['processors']} processors; {' '.join(about['flags'])}; "
            f"caches: {cache_sizes(about) or 'unknown'}; {at['date']}\n")


def sets_of(about):
    return [name for name, needed in SETS.items() if all(flag in about["flags"] for flag in needed)]


def available_memory():
    for line in pathlib.Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable"):
            return 1024 * int(line.split()[1])
    return 0


def commit(root, sources):
    """Of the tree at root, such as "367a92b" or "367a92b with changes" if these sources are not as committed."""
    def git(*arguments):
        try:
            done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True, check=False)
        except FileNotFoundError:  # a machine without git
            return ""
        return done.stdout.strip() if done.returncode == 0 else ""

    name = git("rev-parse", "--short", "HEAD")
    return (name or "unknown") + (" with changes" if git("status", "--porcelain", "--", *sources) else "")


class OtherWork:
    """Processors' worth of work on this machine that was not ours, and of time that its host took away."""

    def __init__(self):
        self.start = time.monotonic(), *self.used()

    @staticmethod
    def used():
        """Seconds of all processes, stolen by the host, and of our own."""
        fields = [int(f) for f in pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]]
        per_second = os.sysconf("SC_CLK_TCK")
        user, nice, system, _, _, irq, soft_irq, stolen = fields[:8]
        usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        ours = sum(u.ru_utime + u.ru_stime for u in usages)
        return (user + nice + system + irq + soft_irq) / per_second, stolen / per_second, ours

    def result(self):
        clock, everything, stolen, ours = (b - a for a, b in zip(self.start, (time.monotonic(), *self.used())))
        return {"other_processors": max(0.0, everything - ours) / clock, "stolen_processors": stolen / clock}
