{
  const record = JSON.parse(document.getElementById("record").textContent);
  const place = document.getElementById("view-place");
  gaiterViewer.mount(place, record, { language: document.documentElement.lang });
}
