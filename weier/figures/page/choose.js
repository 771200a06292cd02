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
// A method is named in the legends if it has a curve of this case.
const start = rows[0] * loads
sources.forEach((source, number) => {
  const slice = (name) => Array.from(allCurves.data[name].slice(start, start + loads))
  const curve = { ...source.data, mean_pressure: slice("mean_pressure") }
  for (const name of shown) curve[name] = slice(`${name} ${methods[number]}`)
  source.data = curve
  for (const legend of legends) legend.items[number].visible = curve.compliance.some(Number.isFinite)
})
