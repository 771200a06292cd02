# The documentation, with the paper's figures as they are now: snakemake --cores 2 docs
rule docs:
    input:
        scene="config/scenes/paper.yaml",
        source=sorted(str(path) for path in Path("weier").rglob("*.py")),
        pages=[
            path
            for kind in ("py", "rst", "md", "css")
            for path in sorted(map(str, Path("docs").glob(f"*.{kind}")))
        ],
        figures=lambda w: expand(
            "results/paper/figures/{f}.png", f=scene("paper").figures
        ),
    output:
        "results/docs/index.html",
    log:
        "results/logs/docs.log",
    conda:
        "environment.yaml"
    shell:
        "sphinx-build --fail-on-warning --keep-going --quiet --fresh-env docs results/docs 2>&1 | tee {log}"
