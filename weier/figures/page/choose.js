// Each label leaves a choice to the ones after it: keep what is chosen where it still exists, else take the first.
let rows = labels.D.map((_, row) => row)
for (const select of selects) {
  const values = labels[select.name]
  const options = [...new Set(rows.map((row) => values[row]))]
  select.options = options
  if (!options.includes(select.value)) select.value = options[0]
  rows = rows.filter((row) => values[row] === select.value)
}
const key = selects[selects.length - 1]
key.visible = key.options.length > 1
// A method is drawn, and named in the legends, where it is wanted and has a curve of this case.
const start = rows[0] * loads
sources.forEach((source, number) => {
  const part = (quantity) => Array.from(every.data[`${quantity} ${methods[number]}`].slice(start, start + loads))
  const compliance = part("compliance")
  source.data = { mean_pressure: source.data.mean_pressure, compliance, resistance: part("resistance") }
  const shown = boxes.active.includes(number) && compliance.some(Number.isFinite)
  for (const legend of legends) {
    const item = legend.items[number]
    item.visible = item.renderers[0].visible = shown
  }
})
