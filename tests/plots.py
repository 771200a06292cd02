"""The directive `plot` in tests of the site: the code of examples, which doctest runs, without their pictures."""

from docutils import nodes
from matplotlib.sphinxext.plot_directive import PlotDirective


class Plot(PlotDirective):
    """The code of an example alone."""

    def run(self):
        """A block of code."""
        code = "\n".join(self.content)
        return [nodes.literal_block(code, code)]


def setup(app):
    """In the place of the directive of matplotlib."""
    app.setup_extension("matplotlib.sphinxext.plot_directive")
    app.add_directive("plot", Plot, override=True)
