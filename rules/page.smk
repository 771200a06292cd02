# An HTML page for each scene: snakemake --cores 2 pages --config scenes=paper
rule pages:
    input:
        expand("results/{scene}/page.html", scene=SCENES),


rule page:
    input:
        contact=ancient("results/{scene}/contact.nc"),
        figures=ancient(scenes.figures),
        outdated=scenes.outdated_page,
    output:
        "results/{scene}/page.html",
    log:
        "results/logs/{scene}/page.log",
    conda:
        "environment.yaml"
    params:
        scene=scenes.scene_file,
    message:
        "{wildcards.scene}: write the page"
    shell:
        "python -m weier page {params.scene:q} results/curves {input.contact:q} {output:q}"
        " results/{wildcards.scene}/figures 2>&1 | tee -i {log:q}"
