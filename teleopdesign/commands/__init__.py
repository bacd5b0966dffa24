"""The commands of `teleopdesign`: one file is one command, named by the file.

Each has add(parser), which adds the arguments to the parser, and run(options), which does the work
and returns the exit status. Its docstring's first line is the help. What takes time to import is
imported in run, so that every other command stays instant.
"""

#: exit status of what Ctrl-C stopped
STOPPED = 130
