"""Compile: makes kernels.ptx of the kernels, or checks it with --check.

NVRTC needs no GPU: pip install -r requirements.txt
That release writes PTX that drivers from 530 on take. Products and sums are not fused.
"""

import ctypes
import importlib.util
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
PTX = FOLDER / "kernels.ptx"
RELEASE = (12, 1)
OPTIONS = ["--gpu-architecture=compute_75", "--fmad=false", "--std=c++17"]


def checksum():
    """FNV-1a of all sources, by which a test sees that the PTX is of them."""
    value = 0xCBF29CE484222325
    for file in sorted(FOLDER.glob("*.h")) + [FOLDER / "kernels.cu"]:
        for byte in file.read_bytes():
            value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def library():
    """The library of the installed package, or None."""
    try:
        package = importlib.util.find_spec("nvidia.cuda_nvrtc")
    except ModuleNotFoundError:
        return None
    if package is None:
        return None
    folders = [pathlib.Path(folder) for folder in package.submodule_search_locations]
    files = [file for folder in folders for file in sorted(folder.rglob("*nvrtc*"))]
    # The library of the compiler loads the other one
    names = [file for file in files if file.name in ("libnvrtc.so.12", "nvrtc64_120_0.dll")]
    return ctypes.CDLL(str(names[0])) if names else None


def check(nvrtc, status, program=None):
    """Ends the program with the messages of the compiler if it has failed."""
    if status == 0:
        return
    size = ctypes.c_size_t()
    if program is not None and nvrtc.nvrtcGetProgramLogSize(program, ctypes.byref(size)) == 0:
        log = ctypes.create_string_buffer(size.value)
        nvrtc.nvrtcGetProgramLog(program, log)
        sys.exit(log.value.decode())
    sys.exit(f"NVRTC reports {status}")


def ptx(nvrtc):
    """PTX of the kernels."""
    headers = sorted(FOLDER.glob("*.h"))
    texts = [header.read_bytes() for header in headers]
    names = [header.name.encode() for header in headers]
    strings = ctypes.c_char_p * len(headers)
    program = ctypes.c_void_p()
    source = (FOLDER / "kernels.cu").read_bytes()
    check(nvrtc, nvrtc.nvrtcCreateProgram(ctypes.byref(program), source, b"kernels.cu", len(headers), strings(*texts), strings(*names)))
    options = (ctypes.c_char_p * len(OPTIONS))(*[option.encode() for option in OPTIONS])
    check(nvrtc, nvrtc.nvrtcCompileProgram(program, len(OPTIONS), options), program)
    size = ctypes.c_size_t()
    check(nvrtc, nvrtc.nvrtcGetPTXSize(program, ctypes.byref(size)))
    text = ctypes.create_string_buffer(size.value)
    check(nvrtc, nvrtc.nvrtcGetPTX(program, text))
    return f"// Sources: {checksum():016x}\n{text.value.decode()}"


def main():
    nvrtc = library()
    if nvrtc is None:
        sys.exit("NVRTC is not installed: see the text of this script")
    major, minor = ctypes.c_int(), ctypes.c_int()
    nvrtc.nvrtcVersion(ctypes.byref(major), ctypes.byref(minor))
    if (major.value, minor.value) != RELEASE:
        print(f"skipped: NVRTC {major.value}.{minor.value} is installed, not {RELEASE[0]}.{RELEASE[1]}")
        return
    text = ptx(nvrtc)
    fused = [line for line in text.splitlines() if "fma." in line]
    if fused:
        sys.exit("fused products and sums: " + fused[0].strip())
    if "--check" not in sys.argv:
        PTX.write_text(text)
    elif PTX.read_text() != text:
        sys.exit("kernels.ptx is not what its source gives: run this script")
    print(f"{PTX.name}: {len(text)} bytes, no fused operations")


main()
