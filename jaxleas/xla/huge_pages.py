"""Large memory pages for arrays that are read at scattered places."""

import ctypes
import sys

from jax import Array

_SIZE = 2 * 2**20  # size of a large page [B]
_MADV_HUGEPAGE, _MADV_COLLAPSE = 14, 25  # <linux/mman.h>; the second since Linux 6.1


def hold_in_huge_pages(array: Array) -> bool:
    """Ask Linux to hold an array of this process's memory in large pages.

    A gather from a whole atlas touches thousands of pages of 4 KiB, more than a processor caches
    addresses of. Parts that do not fill a large page stay as they are; so does everything on other
    systems and devices.

    Returns:
        Whether Linux granted it.
    """
    devices = array.devices()
    if sys.platform != "linux" or {each.platform for each in devices} != {"cpu"}:
        return False
    if len(devices) > 1 or not array.is_fully_addressable:
        return False
    begin = array.unsafe_buffer_pointer()
    first = -(-begin // _SIZE) * _SIZE
    length = (begin + array.nbytes) // _SIZE * _SIZE - first
    if length <= 0:
        return False
    madvise = ctypes.CDLL(None, use_errno=True).madvise
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    # Kernels too old for the second call do it some time after the first.
    return (
        madvise(first, length, _MADV_HUGEPAGE) == 0 and madvise(first, length, _MADV_COLLAPSE) == 0
    )
