"""Claims over intervals of a diagram's values: proved over the whole box, refuted, or checked.

`box` holds the intervals of the values that vary. `linear` keeps these values as symbols in the
equations of all states, and `late` does so with dead times. `worst` searches the box for the least
margin. `over_box` combines all of this.
"""
