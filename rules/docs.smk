# The documentation, with the figures of the paper: snakemake --cores 2 docs
rule docs:
    input:
        figures=figures_of_documentation,
        index=str(CHECKOUT / "docs/index.rst"),
        others=[
            str(path)
            for path in sorted(CHECKOUT.glob("docs/**/*"))
            if path.suffix in {".py", ".rst", ".md", ".css", ".png"}
        ],
    output:
        "results/docs/index.html",
    log:
        "results/logs/docs.log",
    conda:
        environment
    params:
        depends_on=digest_of_sources(""),
    shell:
        "sphinx-build --fail-on-warning --keep-going --quiet --fresh-env"
        ' -D scene_figures="$PWD/results/paper/figures" "$(dirname {input.index:q})" results/docs 2>&1 | tee -i {log:q}'
