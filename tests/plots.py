"""The directive `plot` in tests of the site: pages whose code doctest runs, all of it, show their code alone."""

from docutils import nodes
from matplotlib.sphinxext.plot_directive import PlotDirective

NOT_RUN = ("first_day", "tutorial")  # fifteen seconds; the pictures of the other page are drawn


class Plot(PlotDirective):
    """The code without its picture on these pages."""

    def run(self):
        """A block of code, or what the directive of matplotlib makes."""
        if self.state.document.settings.env.docname not in NOT_RUN:
            return super().run()
        code = "\n".join(self.content)
        return [nodes.literal_block(code, code)]


def setup(app):
    """In the place of the directive of matplotlib."""
    app.setup_extension("matplotlib.sphinxext.plot_directive")
    app.add_directive("plot", Plot, override=True)
