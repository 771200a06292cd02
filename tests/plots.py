"""The directive `plot` in tests of the site: one page, whose code doctest runs as well, shows its code alone."""

from docutils import nodes
from matplotlib.sphinxext.plot_directive import PlotDirective

NOT_RUN = "first_day"  # ten seconds; the pictures of the other pages are drawn


class Plot(PlotDirective):
    """The code without its picture on that page."""

    def run(self):
        """A block of code, or what the directive of matplotlib makes."""
        if self.state.document.settings.env.docname != NOT_RUN:
            return super().run()
        code = "\n".join(self.content)
        return [nodes.literal_block(code, code)]


def setup(app):
    """In the place of the directive of matplotlib."""
    app.setup_extension("matplotlib.sphinxext.plot_directive")
    app.add_directive("plot", Plot, override=True)
