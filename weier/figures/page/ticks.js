// Ticks of a logarithmic axis, major ones or, once these are known, minor ones: powers of ten over many decades, 2 and 5
// times these as well over few, and equal steps within one, so that some three numbers always stand at the axis.
const { start, end, major_ticks } = cb_data
const inside = (ticks) => ticks.filter((tick) => start <= tick && tick <= end)
const times = (factors, step) => {
  const ticks = []
  for (let n = step * Math.floor(Math.log10(start) / step); n <= Math.log10(end); n += step)
    for (const factor of factors) ticks.push(Number(`${factor}e${n}`))
  return inside(ticks)
}
const decades = Math.log10(end / start)
if (!(decades > 0) || !Number.isFinite(decades)) return []
if (decades < 1) {
  const unit = 10 ** Math.floor(Math.log10((end - start) / 4))
  const factor = [5, 2, 1].find((each) => each * unit <= (end - start) / 4)
  const step = major_ticks ? (factor * unit) / (factor === 2 ? 4 : 5) : factor * unit
  const count = Math.floor(end / step) - Math.ceil(start / step) + 1
  return Array.from({ length: count }, (_, n) => Number(((Math.ceil(start / step) + n) * step).toPrecision(12)))
}
const step = Math.ceil(decades / 9)
if (major_ticks) return times(step > 1 ? [1] : [1, 2, 3, 4, 5, 6, 7, 8, 9], 1)
return decades < 2.5 ? times([1, 2, 5], 1) : times([1], step)
