"""The paper's experiments: which episodes, played where, tested how, drawn and written down."""
