"""A tracker that is not there: it obeys a real one's commands, on pseudo-terminals or over UDP, before a subject.

The flow: a `Performance` becomes what fifteen sensors measure (`stage`, from `sensors` and `noise`), a `Machine` makes
records of it as it is told, and a `line` carries them no faster than its baud rate, with what `faults` do to them.
"""
