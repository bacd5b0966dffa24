"""Claims over intervals of a diagram's values: proved over the whole box, refuted, or checked.

`box` holds the intervals of the values that vary. `family` writes the diagram with these values as
symbols. `conditions` turns a claim into signs of polynomials, and `bernstein` shows these signs
over the box in exact arithmetic. `worst` searches the box for the least margin. `over_box` combines
all of this.
"""
