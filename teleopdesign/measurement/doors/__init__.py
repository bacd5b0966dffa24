"""Files that loggers write, one door each: csv of any dialect, parquet, xlsx, mat, npz, h5, bags.

A door opens a file as a `Log`: the names of its columns, and a function that reads some of them.
Sizes are looked at before anything is read, and nothing in a file is run.
"""
