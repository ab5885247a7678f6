"""The viewer as one function: a window, or pictures into files, of a server or of a recording."""

from __future__ import annotations

from collections.abc import Callable

from ahmss_viewer.options import CAMERAS, ViewOptions, ViewReport

__all__ = ["CAMERAS", "ViewOptions", "ViewReport", "view"]


def view(options: ViewOptions, progress: Callable[[int, int], None] | None = None) -> ViewReport:
    """View a world as the options say; returns when it is done, closed, interrupted or terminated.

    Args:
        options: what to view and how.
        progress: told the frames done and all frames, while a recording is drawn into files.

    Raises:
        DataError: a recording can't be read, or a file not be written.
        DependencyError: there is no display for a window, or no OpenGL without one.
        CommandError: options that exclude each other.
    """
    # OpenGL is bound to a window or to none when it is first imported; so each way imports it for itself.
    if options.draws_files:
        if options.replay is not None:
            from ahmss_viewer.graphics import use_headless

            use_headless()
            from ahmss_viewer.replaying import replay

            return replay(options, options.replay, progress)
        from ahmss_viewer.graphics import use_headless

        use_headless()
        from ahmss_viewer.live import watch

        return watch(options)
    from ahmss_viewer.graphics import use_window
    from ahmss_viewer.source import Replay

    if options.replay is not None:  # what is wrong with it is told before what is wrong with the display
        Replay(options.replay).close()
    use_window()
    from ahmss_viewer.window import show

    return show(options)
