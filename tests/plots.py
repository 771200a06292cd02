"""The directive `plot` in tests of the site: code that doctest runs is shown without its picture."""

from docutils import nodes
from matplotlib.sphinxext.plot_directive import PlotDirective


class Plot(PlotDirective):
    """The code of an example alone."""

    def run(self):
        """A block of code, or what the directive of matplotlib makes of code without prompts."""
        code = "\n".join(self.content)
        return [nodes.literal_block(code, code)] if ">>>" in code else super().run()


def setup(app):
    """In the place of the directive of matplotlib."""
    app.setup_extension("matplotlib.sphinxext.plot_directive")
    app.add_directive("plot", Plot, override=True)
