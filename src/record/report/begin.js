{
  const first = document.getElementById("first-only");
  first.addEventListener("change", () => document.documentElement.classList.toggle("first-only", first.checked));
  document.getElementById("print").addEventListener("click", () => window.print());
  const record = JSON.parse(document.getElementById("record").textContent);
  const place = document.getElementById("view-place");
  gaiterViewer.mount(place, record, { language: document.documentElement.lang });
}
