"""The record formats of trackers: each file encodes a reading and parses a stream, in one place.

`encode(reading, layout) -> bytes` is what a device sends; `parser(layout)` makes an incremental parser whose
`feed(data, arrival) -> list[Reading]` finds the records in any stream of bytes, however damaged, and counts its losses.
"""
