// The viewer of a leg: gaiterViewer.mount(element, record, {language}).
