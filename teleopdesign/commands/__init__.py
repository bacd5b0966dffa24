"""The commands of `teleopdesign`: one file is one command, named by the file.

Each file has add(parser), which adds the arguments to the parser, and run(options), which does the
work and returns the exit status. The first line of the file's docstring is the help text. Modules
that take time to import are imported in run, so that every other command starts at once.
"""

#: exit status of what Ctrl-C stopped
STOPPED = 130
