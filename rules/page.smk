# An HTML page for each scene: snakemake --cores 2 pages --config scenes=paper
rule pages:
    input:
        expand("results/{scene}/page.html", scene=SCENES),


rule page:
    input:
        contact="results/{scene}/contact.nc",
        figures=scenes.figures,
    output:
        "results/{scene}/page.html",
    log:
        "results/logs/{scene}/page.log",
    conda:
        "environment.yaml"
    params:
        scene=scenes.scene_file,
        depends_on=scenes.page_digest,
    message:
        "{wildcards.scene}: write the page"
    shell:
        "python -m weier page {params.scene:q} results/{wildcards.scene}/batches {input.contact:q} {output:q}"
        " results/{wildcards.scene}/figures 2>&1 | tee -i {log:q}"
