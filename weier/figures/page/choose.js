// Each list offers the labels of the cases that agree with all lists further left. What is chosen in a list is kept
// where it is still offered; otherwise the first label is chosen.
let rows = labels.D.map((_, row) => row)
for (const select of selects) {
  const values = labels[select.name]
  const options = [...new Set(rows.map((row) => values[row]))]
  select.options = options
  select.visible = options.length > 1 || (options[0] !== "-" && select.name !== "case")
  if (!options.includes(select.value)) select.value = options[0]
  rows = rows.filter((row) => values[row] === select.value)
}
// A method has a box if it has a curve of this case, and is drawn and named in the legends if its box is ticked.
const start = rows[0] * loads
sources.forEach((source, number) => {
  const curve = (quantity) => Array.from(allCurves.data[`${quantity} ${methods[number]}`].slice(start, start + loads))
  const compliance = curve("compliance")
  source.data = { mean_pressure: source.data.mean_pressure, compliance, resistance: curve("resistance") }
  boxes[number].visible = compliance.some(Number.isFinite)
  const drawn = boxes[number].visible && boxes[number].active
  for (const legend of legends) {
    const item = legend.items[number]
    item.visible = item.renderers[0].visible = drawn
  }
})
