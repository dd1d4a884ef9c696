"""Formats that a library reads: in a process of their own, with limits on memory and time.

Libraries are made for files of people one knows. For others they may crash, hang, or take all
memory; then that process ends, and the answer is one sentence. See `asking` and `server`.
"""
