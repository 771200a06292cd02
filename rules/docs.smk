# The documentation, with the paper's figures as they are now: snakemake --cores 2 docs
if "paper" in drawn_together():

    rule docs:
        input:
            list(rules.figures_paper.output),  # of a named input, Snakemake forgets the rule
            documentation_tools,
            scene=scene_file("paper"),
            pages=in_checkout(
                *(
                    path
                    for kind in ("py", "rst", "md", "css")
                    for path in sorted(CHECKOUT.joinpath("docs").rglob(f"*.{kind}"))
                )
            ),
        output:
            "results/docs/index.html",
        log:
            "results/logs/docs.log",
        conda:
            "environment.yaml"
        params:
            docs=in_checkout("docs"),
            program=digest_of_program(""),
        shell:
            "sphinx-build --fail-on-warning --keep-going --quiet --fresh-env"
            ' -D scene_figures="$PWD"/results/paper/figures {params.docs:q} results/docs 2>&1 | tee -i {log:q}'
