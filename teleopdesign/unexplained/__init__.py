"""Where a model fails, and a description of the residual that no candidate explains.

description = describe_residual(model, prepared)
description.findings    sentences, each with its numbers and its graph
description.parts       per body: views, tests, curves with bands, formulas
description.plot()      the views and the dependences
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .result import BodyResidual as BodyResidual
    from .result import DescribedDependence as DescribedDependence
    from .result import ResidualDescription as ResidualDescription
    from .result import describe as describe
    from .result import describe_residual as describe_residual
    from .result import where_it_fails as where_it_fails

__getattr__, __dir__, __all__ = lazy_face(__name__)
