# An explorer of the curves of each scene, which a report of this target includes beside figures and claims:
# snakemake --cores 2 pages --config scenes=paper; snakemake pages --config scenes=paper --report
rule pages:
    input:
        scenes.products,
        expand("results/{scene}/page.html", scene=SCENES),


rule page:
    input:
        contact=ancient("results/{scene}/contact.nc"),
        outdated=scenes.outdated_page,
    output:
        report(
            "results/{scene}/page.html",
            category="{scene}",
            subcategory="curves",
            labels={"figure": "explorer", "caption": "The curves of all cases"},
        ),
    log:
        "results/logs/{scene}/page.log",
    conda:
        "environment.yaml"
    params:
        scene=scenes.scene_file,
    message:
        "{wildcards.scene}: write the explorer of all curves"
    shell:
        "python -m weier page {params.scene:q} results/curves {input.contact:q} {output:q} 2>&1 | tee -i {log:q}"
