from weier.pipeline.dependencies import page_digest


# One HTML page a scene, to look through: snakemake --cores 2 pages --config scenes=paper
rule pages:
    input:
        expand("results/{s}/page.html", s=scene_names()),


rule page:
    input:
        contact="results/{scene}/contact.nc",
        figures=lambda w: expand(
            "results/{{scene}}/figures/{f}.png", f=scene(w.scene).figures
        ),
        costs=lambda w: expand(
            "results/{{scene}}/cost/{b}.nc", b=scene(w.scene).batches
        ),
    output:
        "results/{scene}/page.html",
    log:
        "results/logs/{scene}/page.log",
    conda:
        "environment.yaml"
    params:
        scene=lambda w: scene_file(w.scene),
        figures=lambda w: repr(scene(w.scene).figures),
        program=lambda w: page_digest(),
    shell:
        "python -m weier page {params.scene} {output}"
        " {input.contact} {input.figures} {input.costs} 2>&1 | tee -i {log}"
